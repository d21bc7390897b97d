# SPDX-License-Identifier: BSD-3-Clause
# SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
"""Detector and virtual cell as seen by the scripts of the demo."""
import collections
import threading

import numpy
import rospy
from bin_picking_perception.msg import ReturnCode, SceneTruth
from bin_picking_perception.srv import GetBestGrasp, GetBestGraspRequest

START_TIME = 120               # seconds until a node answers, or the bin is full
TRAINING_TIME = 600            # seconds that the first start may take
TRUTHS_KEPT = 100              # exposures that may pass while the detector works on one of them


def pose_matrix(pose):
    p, q = pose.position, pose.orientation
    x, y, z, w = q.x, q.y, q.z, q.w
    return numpy.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), p.x],
                        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), p.y],
                        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), p.z],
                        [0, 0, 0, 1]])


class Truth:
    """The truths that the cell has published, by the stamp of their clouds."""

    def __init__(self, cell):
        self._truths = collections.deque(maxlen=TRUTHS_KEPT)
        self._changed = threading.Condition()
        self._subscriber = rospy.Subscriber(cell + "/truth", SceneTruth, self._store)

    def _store(self, truth):
        with self._changed:
            self._truths.append(truth)
            self._changed.notify_all()

    def _wait(self, wanted, what):
        with self._changed:
            if not self._changed.wait_for(lambda: any(map(wanted, self._truths)), START_TIME):
                raise rospy.ROSException(f"{self._subscriber.resolved_name} brought no truth {what} within"
                                         f" {START_TIME} s; look at the log of the virtual cell.")
            return next(filter(wanted, reversed(self._truths)))

    def newest(self):
        return self._wait(lambda _: True, "at all")

    def at(self, stamp):
        return self._wait(lambda truth: truth.header.stamp == stamp, f"of the cloud {stamp.to_sec():.3f}")

    def since(self, time):
        return self._wait(lambda truth: truth.header.stamp >= time, f"since {time.to_sec():.3f}")


class Detector:
    def __init__(self, name):
        service = name + "/get_best_grasp"
        rospy.wait_for_service(service, timeout=START_TIME)
        self._get_best_grasp = rospy.ServiceProxy(service, GetBestGrasp)

    def ask(self, frame, accept_undetermined_turn=False):
        """The answer for a cloud exposed from now on, with all poses in the frame."""
        request = GetBestGraspRequest(acquisition=GetBestGraspRequest.WAIT_NEW, output_frame=frame,
                                      accept_undetermined_turn=accept_undetermined_turn)
        response = self._get_best_grasp(request)
        end = rospy.get_time() + TRAINING_TIME
        while response.code.value == ReturnCode.NOT_READY and rospy.get_time() < end and not rospy.is_shutdown():
            rospy.sleep(0.5)  # the part is being trained or its model loaded
            response = self._get_best_grasp(request)
        return response
