#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
# SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
"""Empties the virtual bin: again and again takes the part that the detector, or the truth, holds for the best one.

Usage: empty_bin.py [--by detector|truth] [--detector NAME] [--cell NAME]      the cell must have a rate
Prints a line per pick. Exit code 0: the bin is empty, also if it was from the start; 1: parts are left because several attempts
in a row took none.
"""
import argparse
import collections
import sys
import time

import rospy
from bin_picking_perception.msg import ReturnCode
from bin_picking_perception.srv import TakePart, TakePartRequest, TakePartResponse

from demo_client import START_TIME, Detector, Truth

EMPTY = "empty"                # in place of a request: there is nothing to take
MAX_FRUITLESS = 6              # attempts in a row that take nothing; then the rest is given up
OUTCOMES = {TakePartResponse.TAKEN: "taken", TakePartResponse.MISSED: "missed",
            TakePartResponse.DROPPED_BACK: "dropped back", TakePartResponse.NO_SUCH_PART: "nothing there"}


class ByTruth:
    """The part that is seen best; of equal ones the nearer to the camera."""

    def __init__(self, cell):
        self._truth = Truth(cell)

    def choose(self, _):
        scene = self._truth.since(rospy.Time.now())
        if not scene.instances:
            return EMPTY, "the bin is empty"
        best = max(scene.instances, key=lambda part: (part.visible_fraction, -part.pose.position.z))
        return TakePartRequest(select=TakePartRequest.BY_ID, id=best.id), f"{100 * best.visible_fraction:.0f} % visible"


class ByDetector:
    """The part of the best grasp; without a grasp the best detection; after a failure the next best."""

    def __init__(self, cell, detector):
        self._frame = Truth(cell).newest().header.frame_id  # the camera's, from which ~take_part needs no tf
        self._detector = Detector(detector)

    def choose(self, rank):
        response = self._detector.ask(self._frame, accept_undetermined_turn=True)  # out is out, however turned
        candidates = {}  # each detection once, those with a grasp first
        for grasp in response.grasps:
            candidates.setdefault(grasp.detection_index, f"grasp {grasp.grasp_id}, quality {grasp.quality:.2f}")
        for detection in response.detections:
            if detection.accepted:
                candidates.setdefault(detection.index, f"no grasp, score {detection.score:.2f}")
        if not candidates:
            is_empty = response.code.value == ReturnCode.BIN_EMPTY
            return EMPTY if is_empty else None, f"{response.code.name}: {response.code.message}"
        index, why = list(candidates.items())[rank % len(candidates)]
        detection = response.detections[index]
        request = TakePartRequest(select=TakePartRequest.BY_POSE, part=detection.part)
        request.pose.header = detection.header
        request.pose.pose = detection.pose
        return request, why


def empty(chooser, take_part):
    """Counts of the outcomes, and how many parts are left; None: nobody knows."""
    counts = collections.Counter()
    fruitless = 0
    num_left = None
    while num_left != 0 and fruitless < MAX_FRUITLESS and not rospy.is_shutdown():
        start = time.monotonic()
        request, why = chooser.choose(fruitless)
        if request is EMPTY and not num_left:  # else the cell knows of parts that nobody sees
            print(f"      {why}")
            return counts, 0
        if request in (None, EMPTY):
            print(f"      {why}")
            fruitless += 1
            continue
        answer = take_part(request)
        if answer.outcome < 0:
            raise rospy.ServiceException(answer.message)
        outcome = OUTCOMES[answer.outcome]
        counts[outcome] += 1
        num_left = answer.num_left
        fruitless = 0 if answer.outcome == TakePartResponse.TAKEN else fruitless + 1
        print(f"{sum(counts.values()):4}  {outcome:13}  {answer.id:3}  {answer.part or request.part:20}"
              f"  {num_left:2} left  {time.monotonic() - start:5.1f} s  {why}", flush=True)
    return counts, num_left


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--by", choices=["detector", "truth"], default="detector", help="who says which part is next")
    parser.add_argument("--detector", default="detector", help="name of the detector's node")
    parser.add_argument("--cell", default="virtual_cell", help="name of the cell's node")
    arguments = parser.parse_args(rospy.myargv()[1:])

    rospy.init_node("empty_bin", anonymous=True)
    rospy.wait_for_service(arguments.cell + "/take_part", timeout=START_TIME)
    take_part = rospy.ServiceProxy(arguments.cell + "/take_part", TakePart)
    start = time.monotonic()
    by_truth = arguments.by == "truth"
    chooser = ByTruth(arguments.cell) if by_truth else ByDetector(arguments.cell, arguments.detector)
    counts, num_left = empty(chooser, take_part)
    print("\n" + (", ".join(f"{count} {outcome}" for outcome, count in counts.items()) or "nothing tried") +
          f"; {'unknown how many' if num_left is None else num_left} left after {time.monotonic() - start:.0f} s")
    return 0 if num_left == 0 else 1


if __name__ == "__main__":
    try:
        sys.exit(main())
    except (rospy.ROSException, rospy.ServiceException) as problem:
        sys.exit(f"empty_bin: {problem}")
