#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
# SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
"""Asks a running detector for the best grasp in a demo scene and holds the answer against the scene's truth.

Usage: demo_report.py SCENE_DIR PART_DIR [--frame CAMERA_FRAME] [--service NAME]
Exit code 1 if there is no grasp, or if the part of the best grasp is off by more than 5 mm or 5 degrees.
"""
import argparse
import json
import os
import sys

import numpy
import rospy
import yaml

from bin_picking_perception.msg import ReturnCode
from bin_picking_perception.srv import GetBestGrasp, GetBestGraspRequest

MAX_TRANSLATION = 0.005        # metres
MAX_ROTATION = numpy.radians(5)
MAX_GROUP = 120                # elements of a finite symmetry group
CONTINUOUS_STEPS = 720         # of an axis of revolution: half a degree each
VISIBLE = 0.5                  # parts hidden more than this are no fair target
TRAINING_TIME = 600            # seconds that the first start may take


def rotation_about(axis, angle, origin):
    """4x4 rotation by angle about the axis through origin."""
    x, y, z = numpy.asarray(axis, float) / numpy.linalg.norm(axis)
    cross = numpy.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    motion = numpy.eye(4)
    motion[:3, :3] += numpy.sin(angle) * cross + (1 - numpy.cos(angle)) * cross @ cross
    motion[:3, 3] = origin - motion[:3, :3] @ origin
    return motion


def origin_of(entry):
    return numpy.array(entry.get("origin", [0, 0, 0]), float)


def symmetries(part_dir):
    """All poses of the part that look the same, as part.yaml declares them."""
    with open(os.path.join(part_dir, "part.yaml"), encoding="utf-8") as file:
        declared = yaml.safe_load(file).get("symmetry") or {}
    generators = [rotation_about(entry["axis"], 2 * numpy.pi / entry["order"], origin_of(entry))
                  for entry in declared.get("discrete", [])]
    group = [numpy.eye(4)]
    for element in group:  # grows while it is walked, until it is closed
        for generator in generators:
            product = element @ generator
            if len(group) < MAX_GROUP and not any(numpy.allclose(product, other, atol=1e-6) for other in group):
                group.append(product)
    axis = declared.get("continuous")
    if axis:
        turns = [rotation_about(axis["axis"], 2 * numpy.pi * i / CONTINUOUS_STEPS, origin_of(axis))
                 for i in range(CONTINUOUS_STEPS)]
        group = [element @ turn for element in group for turn in turns]
    return numpy.array(group)


def pose_matrix(pose):
    p, q = pose.position, pose.orientation
    x, y, z, w = q.x, q.y, q.z, q.w
    return numpy.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), p.x],
                        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), p.y],
                        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), p.z],
                        [0, 0, 0, 1]])


def pose_error(estimate, truth, group):
    """(translation, rotation) to the symmetric equivalent of the truth that is nearest in rotation."""
    equivalents = truth @ group
    traces = numpy.einsum("ij,nij->n", estimate[:3, :3], equivalents[:, :3, :3])
    nearest = int(numpy.argmax(traces))
    cosine = numpy.clip((traces[nearest] - 1) / 2, -1, 1)
    return numpy.linalg.norm(estimate[:3, 3] - equivalents[nearest, :3, 3]), numpy.arccos(cosine)


def nearest_instance(estimate, instances, group):
    errors = [pose_error(estimate, truth, group) for truth, _ in instances]
    index = min(range(len(errors)), key=lambda i: errors[i][0] / MAX_TRANSLATION + errors[i][1] / MAX_ROTATION)
    return index, errors[index]


def is_right(error):
    return error[0] <= MAX_TRANSLATION and error[1] <= MAX_ROTATION


def ask(service, frame):
    rospy.wait_for_service(service, timeout=60)
    get_best_grasp = rospy.ServiceProxy(service, GetBestGrasp)
    request = GetBestGraspRequest(acquisition=GetBestGraspRequest.WAIT_NEW, output_frame=frame)
    response = get_best_grasp(request)
    end = rospy.get_time() + TRAINING_TIME
    while response.code.value == ReturnCode.NOT_READY and rospy.get_time() < end and not rospy.is_shutdown():
        rospy.sleep(0.5)  # the part is being trained or its model loaded
        response = get_best_grasp(request)
    return response


def print_detections(detections, instances, group):
    found = set()
    print("\nrank  score  matching  nearest true part   translation    rotation")
    for rank, detection in enumerate(detections):
        index, error = nearest_instance(pose_matrix(detection.pose), instances, group)
        if is_right(error):
            found.add(index)
        print(f"{rank:4}  {detection.score:5.2f}  {100 * detection.matching_rate:6.1f} %"
              f"  {index:3} ({100 * instances[index][1]:3.0f} % visible)"
              f"  {1000 * error[0]:8.2f} mm  {numpy.degrees(error[1]):6.2f} deg{'' if is_right(error) else '  wrong'}")
    fair = {i for i, (_, visible) in enumerate(instances) if visible > VISIBLE}
    print(f"\n{len(fair & found)} of the {len(fair)} parts that are more than {100 * VISIBLE:.0f} % visible are found;"
          f" {len(detections)} detections, {len(found)} different parts right")


def report(response, instances, group):
    print(f"{response.code.name}: {response.code.message} {response.code.hint}".rstrip())
    detections = [detection for detection in response.detections if detection.accepted]
    if detections:
        print_detections(detections, instances, group)
    if response.timing:
        print("\ntimes  " + ", ".join(f"{stage.stage} {1000 * stage.seconds:.1f} ms" for stage in response.timing))
    if not response.grasps:
        print("\nno grasp")
        return False

    best = response.grasps[0]
    T_camera_object = pose_matrix(best.grasp) @ pose_matrix(best.object_in_tip)
    index, error = nearest_instance(T_camera_object, instances, group)
    p = best.grasp.position
    print(f"\nbest of {len(response.grasps)} grasps: {best.grasp_id} at [{p.x:.4f}, {p.y:.4f}, {p.z:.4f}] m in"
          f" {best.header.frame_id}, quality {best.quality:.2f}, tilt {numpy.degrees(best.tilt):.1f} deg,"
          f" {1000 * best.bin_clearance:.0f} mm clear of the bin")
    print(f"its part is true part {index}, off by {1000 * error[0]:.2f} mm and {numpy.degrees(error[1]):.2f} deg:"
          f" {'right' if is_right(error) else 'WRONG'} (limits {1000 * MAX_TRANSLATION:.0f} mm,"
          f" {numpy.degrees(MAX_ROTATION):.0f} deg)")
    return is_right(error)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene_dir", help="made by `bin_picking demo-scene`: holds truth.json")
    parser.add_argument("part_dir", help="holds part.yaml, for the symmetry")
    parser.add_argument("--frame", default="", help="frame of the camera, in which the truth is given")
    parser.add_argument("--service", default="detector/get_best_grasp")
    arguments = parser.parse_args(rospy.myargv()[1:])

    with open(os.path.join(arguments.scene_dir, "truth.json"), encoding="utf-8") as file:
        truth = json.load(file)
    instances = [(numpy.array(instance["T_camera_object"]), instance["visible_fraction"])
                 for instance in truth["instances"]]
    rospy.init_node("demo_report", anonymous=True)
    response = ask(arguments.service, arguments.frame)
    return 0 if report(response, instances, symmetries(arguments.part_dir)) else 1


if __name__ == "__main__":
    try:
        sys.exit(main())
    except (rospy.ROSException, rospy.ServiceException, OSError) as problem:
        sys.exit(f"demo_report: {problem}")
