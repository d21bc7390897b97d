#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
# SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
"""The whole loop of a picking cell: ask for the best grasp, make the moves, grip, report, until the bin is empty.

The same program as src/ros/ur5e_picker.cpp: the arm is a picture and the grip is that of the virtual cell; in a real cell
these two are the robot's driver and the gripper's. Parameters ~frame, ~speed, ~max_fruitless as there.
Where nothing is allowed it shakes the bin and forgets the places that the detector avoids.
Exit code 0: the bin is empty; 1: parts are left (also where the detector sees none), or an error.
"""
import collections
import math
import sys
import time

import rospy
from bin_picking_perception.msg import ReturnCode
from bin_picking_perception.srv import (GetBestGrasp, GetBestGraspRequest, Grip, GripRequest, GripResponse, ReportPick,
                                        ReportPickRequest)
from geometry_msgs.msg import PoseStamped
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger

PATIENCE = 120       # seconds for everything to start; training a part for the first time takes a while
JOINT_SPEED = 1.05   # rad/s, what a UR5e is programmed with by default
JOINTS = ["shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint", "wrist_1_joint", "wrist_2_joint", "wrist_3_joint"]
HOME = [0, -math.pi / 2, math.pi / 2, -math.pi / 2, -math.pi / 2, 0]   # as in config/robots/ur5e.yaml
# Errors of one moment. A few of them in a row end the program as attempts do that take nothing.
PASSING = (ReturnCode.DEADLINE, ReturnCode.NO_CLOUD, ReturnCode.TF_EXTRAPOLATION)
OUTCOMES = {GripResponse.TAKEN: ("picked", ReportPickRequest.PICKED),
            GripResponse.MISSED: ("missed", ReportPickRequest.MISSED),
            GripResponse.DROPPED_BACK: ("dropped", ReportPickRequest.DROPPED),
            GripResponse.COLLISION: ("collision", ReportPickRequest.COLLISION)}


class Problem(Exception):
    """Something that a person has to look at."""


class KinematicArm:
    """Goes where it is told, evenly, and publishes joint_states, from which robot_state_publisher makes tf."""

    RATE = 25  # Hz

    def __init__(self, speed):
        self._speed = speed
        self._joints = HOME
        self._publisher = rospy.Publisher("joint_states", JointState, queue_size=10)
        self._timer = rospy.Timer(rospy.Duration(0.2), lambda _: self._publish())

    def move_to(self, target):
        start = self._joints
        seconds = max(abs(b - a) for a, b in zip(start, target)) / self._speed
        num_steps = max(1, math.ceil(seconds * self.RATE))
        for step in range(1, num_steps + 1):
            time.sleep(min(seconds / num_steps, 1 / self.RATE))
            self._joints = [a + (b - a) * step / num_steps for a, b in zip(start, target)]
            self._publish()

    def _publish(self):
        state = JointState(name=JOINTS, position=self._joints)
        state.header.stamp = rospy.Time.now()
        self._publisher.publish(state)


def urscript(pose):
    """movel for a pose of tool0 in the controller's frame `base`: URScript turns by a rotation vector, axis times angle."""
    p, q = pose.position, pose.orientation
    sine = math.sqrt(q.x ** 2 + q.y ** 2 + q.z ** 2)
    scale = 2 * math.atan2(sine, q.w) / sine if sine > 1e-12 else 2
    numbers = [p.x, p.y, p.z, scale * q.x, scale * q.y, scale * q.z]
    return f"movel(p[{', '.join(f'{number:.6g}' for number in numbers)}], a=1.2, v=0.25)"


class Picker:
    def __init__(self):
        def connect(name, service):
            rospy.wait_for_service(name, timeout=PATIENCE)
            return rospy.ServiceProxy(name, service)

        self._get_best_grasp = connect("detector/get_best_grasp", GetBestGrasp)
        self._report_pick = connect("detector/report_pick", ReportPick)
        self._clear_avoid_list = connect("detector/clear_avoid_list", Trigger)
        self._grip = connect("virtual_cell/grip", Grip)
        self._shake = connect("virtual_cell/shake", Trigger)
        speed = rospy.get_param("~speed", 1.0)
        if not 0 < speed < math.inf:
            raise Problem(f"speed is {speed}; it must be a positive number: 1 is about that of the robot, more is faster")
        self._arm = KinematicArm(JOINT_SPEED * speed)
        self._frame = rospy.get_param("~frame", "base")
        self._max_fruitless = rospy.get_param("~max_fruitless", 12)
        self._start = time.monotonic()
        self._has_started = False
        self._num_attempts = self._num_picked = self._num_left = 0
        self._causes = collections.Counter()  # of what was not a pick

    def run(self):
        """Whether the bin is empty."""
        fruitless = 0
        while fruitless < self._max_fruitless and not rospy.is_shutdown():
            answer = self._ask()
            if answer.code.value == ReturnCode.BIN_EMPTY:
                return self._is_empty(answer.code)
            fruitless += 1
            if answer.grasps:
                if self._pick(answer.grasps[0]):
                    fruitless = 0
                continue
            print(f"      {answer.code.name}: {answer.code.message} ({answer.summary})", flush=True)
            self._causes[answer.code.name] += 1
            if answer.code.value > 0:  # nothing is allowed: the parts have to lie otherwise
                shaken = self._shake()
                if not shaken.success:
                    raise Problem(f"The bin could not be shaken: {shaken.message}")
                print(f"      {shaken.message}", flush=True)
                self._clear_avoid_list()  # what failed lies elsewhere now
        print(f"      Given up: {self._max_fruitless} attempts in a row took nothing (max_fruitless).")
        return False

    def _is_empty(self, code):
        """The detector tells by what is measured, the gripper by what it took: a bin is empty where they agree."""
        if not self._num_left:
            return True
        print(f"      {code.name}: {code.message}. But {self._num_left} parts are left, which the sensor does not measure"
              " or that lean on the walls; look into the bin.")
        return False

    def summary(self):
        causes = "".join(f", {count} {cause}" for cause, count in sorted(self._causes.items()))
        left = f"{self._num_left} left" if self._num_attempts else "nothing tried"
        return (f"{self._num_attempts} attempts: {self._num_picked} picked{causes};"
                f" {left} after {time.monotonic() - self._start:.0f} s")

    def _ask(self):
        """The first answer comes when models, bin and tf are there; from then on, every error is one."""
        request = GetBestGraspRequest(acquisition=GetBestGraspRequest.WAIT_NEW, output_frame=self._frame,
                                      accept_undetermined_turn=True)  # out of the bin is out, however turned
        answer = self._get_best_grasp(request)
        while not self._has_started and answer.code.value < 0 and time.monotonic() - self._start < PATIENCE:
            time.sleep(0.5)
            answer = self._get_best_grasp(request)
        self._has_started = True
        if answer.code.value < 0 and answer.code.value not in PASSING:
            raise Problem(f"{answer.code.name}: {answer.code.message} {answer.code.hint}")
        return answer

    def _pick(self, grasp):
        """Whether the part is out of the bin."""
        self._num_attempts += 1
        print(f"{self._num_attempts:4}  {grasp.uid:10} {grasp.grasp_id} of {grasp.part}, quality {grasp.quality:.2f}:"
              f" {urscript(grasp.grasp_tool0)}", flush=True)
        if grasp.reach_checked:
            self._arm.move_to(grasp.joints_pre_grasp)
            self._arm.move_to(grasp.joints_grasp)
        result = self._grip(self._grip_request(grasp))
        if result.outcome < 0:
            raise Problem(f"The grip could not be made: {result.what}")
        if grasp.reach_checked:
            self._arm.move_to(grasp.joints_retreat)
        self._arm.move_to(HOME)

        print(f"      {result.what}", flush=True)
        name, outcome = OUTCOMES[result.outcome]
        # So that the detector does not offer again what has just failed.
        report = self._report_pick(ReportPickRequest(grasp_uid=grasp.uid, outcome=outcome, note=result.what))
        if report.code.value < 0:
            raise Problem(f"{report.code.name}: {report.code.message} {report.code.hint}")
        self._num_left = result.num_left
        if result.outcome == GripResponse.TAKEN:
            self._num_picked += 1
            return True
        self._causes[name] += 1
        return False

    @staticmethod
    def _grip_request(grasp):
        return GripRequest(pre_grasp=PoseStamped(grasp.header, grasp.pre_grasp_tool0),
                           grasp=PoseStamped(grasp.header, grasp.grasp_tool0),
                           retreat=PoseStamped(grasp.header, grasp.retreat_tool0),
                           opening=grasp.opening, width=grasp.width, part=grasp.part)


def main():
    rospy.init_node("ur5e_picker")
    picker = Picker()
    is_empty = picker.run()
    print(picker.summary())
    return 0 if is_empty else 1


if __name__ == "__main__":
    try:
        sys.exit(main())
    except (Problem, rospy.ROSException, rospy.ServiceException) as problem:
        sys.exit(f"ur5e_picker: {problem}")
