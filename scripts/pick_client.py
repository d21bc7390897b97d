#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
# SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
"""A picking program in its shortest form: ask for the best grasp and act on the code."""
import sys

import rospy
from bin_picking_perception.msg import ReturnCode
from bin_picking_perception.srv import GetBestGrasp, GetBestGraspRequest


def show(name, pose):
    p, q = pose.position, pose.orientation
    print(f"  {name:9} position [{p.x:.4f}, {p.y:.4f}, {p.z:.4f}]"
          f" orientation [{q.x:.4f}, {q.y:.4f}, {q.z:.4f}, {q.w:.4f}]")


def main():
    rospy.init_node("pick_client", anonymous=True)
    rospy.wait_for_service("detector/get_best_grasp", timeout=30)
    get_best_grasp = rospy.ServiceProxy("detector/get_best_grasp", GetBestGrasp)

    request = GetBestGraspRequest(acquisition=GetBestGraspRequest.WAIT_NEW)
    response = get_best_grasp(request)
    while response.code.value == ReturnCode.NOT_READY and not rospy.is_shutdown():
        rospy.sleep(1.0)  # training a part for the first time takes a while
        response = get_best_grasp(request)

    print(f"{response.code.name}: {response.code.message} {response.code.hint}")
    if response.code.value < 0:
        return 1  # a person has to look at it
    if not response.grasps:
        return 0  # nothing to pick: the bin's business

    best = response.grasps[0]
    print(f"Best of {len(response.grasps)} grasps: {best.grasp_id} of {best.part},"
          f" quality {best.quality:.2f}, in {best.header.frame_id}")
    show("pre-grasp", best.pre_grasp)
    show("grasp", best.grasp)
    show("retreat", best.retreat)
    print(f"  open to {best.opening * 1000:.1f} mm, close to {best.width * 1000:.1f} mm")
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except (rospy.ROSException, rospy.ServiceException) as error:
        sys.exit(f"pick_client: {error}")
