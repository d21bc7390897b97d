#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
# SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
"""Asks a running detector for the best grasp in the virtual cell and holds the answer against the cell's truth.

Usage: demo_report.py PART_DIR... [--detector NAME] [--cell NAME]
Exit code 1 if there is no grasp, or if the part of the best grasp is off by more than 5 mm or 5 degrees.
"""
import argparse
import sys

import numpy
import rospy

from demo_client import Detector, Truth, pose_matrix
from part_symmetry import load_symmetries, pose_error, with_turn

MAX_TRANSLATION = 0.005        # metres
MAX_ROTATION = numpy.radians(5)
VISIBLE = 0.5                  # parts hidden more than this are no fair target


def nearest_instance(part, estimate, instances, group):
    """Index of the true part of this kind that is nearest, and its error; None where there is none."""
    errors = {index: pose_error(estimate, pose_matrix(instance.pose), group)
              for index, instance in enumerate(instances) if instance.part == part}
    if not errors:
        return None, (numpy.inf, numpy.pi)
    index = min(errors, key=lambda i: errors[i][0] / MAX_TRANSLATION + errors[i][1] / MAX_ROTATION)
    return index, errors[index]


def is_right(error):
    return error[0] <= MAX_TRANSLATION and error[1] <= MAX_ROTATION


def print_detections(detections, instances, groups):
    found = set()
    print("\nrank  score  matching  nearest true part       translation    rotation")
    for rank, detection in enumerate(detections):
        # What a detection leaves open is no error of it.
        group = with_turn(groups[detection.part], detection)
        index, error = nearest_instance(detection.part, pose_matrix(detection.pose), instances, group)
        if is_right(error):
            found.add(index)
        visible = 100 * instances[index].visible_fraction if index is not None else 0
        name = f"{instances[index].id:3} ({visible:3.0f} % visible)" if index is not None else "none of its kind"
        open_turn = "  turn open" if detection.undetermined_turn else ""
        print(f"{rank:4}  {detection.score:5.2f}  {100 * detection.matching_rate:6.1f} %  {name:20}"
              f"  {1000 * error[0]:8.2f} mm  {numpy.degrees(error[1]):6.2f} deg{'' if is_right(error) else '  wrong'}{open_turn}")
    fair = {i for i, instance in enumerate(instances) if instance.visible_fraction > VISIBLE}
    print(f"\n{len(fair & found)} of the {len(fair)} parts that are more than {100 * VISIBLE:.0f} % visible are found;"
          f" {len(detections)} detections, {len(found)} different parts right")


def clearance_text(grasp):
    """What the gripper passes most closely on its way, against what is required there."""
    if not grasp.collision_checked:
        return "its way not checked"
    if numpy.isinf(grasp.clearance):
        return "nothing near its way"
    if grasp.required_clearance < 0:  # so deep it may go: the held part into what it rests on
        return (f"{1000 * max(0.0, -grasp.clearance):.1f} mm deep ({-1000 * grasp.required_clearance:.1f} mm allowed):"
                f" {grasp.clearance_to}")
    return (f"{1000 * grasp.clearance:.1f} mm clear ({1000 * grasp.required_clearance:.1f} mm required):"
            f" {grasp.clearance_to}")


def report(response, instances, groups):
    print(f"{response.code.name}: {response.code.message} {response.code.hint}".rstrip())
    detections = [detection for detection in response.detections if detection.accepted]
    if detections:
        print_detections(detections, instances, groups)
    if response.timing:
        print("\ntimes  " + ", ".join(f"{stage.stage} {1000 * stage.seconds:.1f} ms" for stage in response.timing))
    if not response.grasps:
        print("\nno grasp")
        return False

    best = response.grasps[0]
    T_camera_object = pose_matrix(best.grasp) @ pose_matrix(best.object_in_tip)
    index, error = nearest_instance(best.part, T_camera_object, instances, groups[best.part])
    p = best.grasp.position
    print(f"\nbest of {len(response.grasps)} grasps: {best.grasp_id} at [{p.x:.4f}, {p.y:.4f}, {p.z:.4f}] m in"
          f" {best.header.frame_id}, quality {best.quality:.2f}, tilt {numpy.degrees(best.tilt):.1f} deg,"
          f" {clearance_text(best)}")
    print(f"its part is true part {instances[index].id if index is not None else 'none'}, off by"
          f" {1000 * error[0]:.2f} mm and {numpy.degrees(error[1]):.2f} deg: {'right' if is_right(error) else 'WRONG'}"
          f" (limits {1000 * MAX_TRANSLATION:.0f} mm, {numpy.degrees(MAX_ROTATION):.0f} deg)")
    return is_right(error)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("part_dirs", nargs="+", metavar="PART_DIR", help="holds part.yaml, for the symmetry")
    parser.add_argument("--detector", default="detector", help="name of the detector's node")
    parser.add_argument("--cell", default="virtual_cell", help="name of the cell's node")
    arguments = parser.parse_args(rospy.myargv()[1:])

    groups = load_symmetries(arguments.part_dirs)
    rospy.init_node("demo_report", anonymous=True)
    truth = Truth(arguments.cell)
    response = Detector(arguments.detector).ask(truth.newest().header.frame_id)
    instances = truth.at(response.header.stamp).instances if response.header.stamp else []
    return 0 if report(response, instances, groups) else 1


if __name__ == "__main__":
    try:
        sys.exit(main())
    except (rospy.ROSException, rospy.ServiceException, OSError) as problem:
        sys.exit(f"demo_report: {problem}")
