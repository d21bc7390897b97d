#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
# SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
"""Puts load on the detector's service and looks whether it bears it: several clients at once, many calls, clouds coming in.

Usage: service_load.py [--calls 1000] [--clients 2] [--detector NAME] [--max-growth MIB]      clouds must arrive, e.g. with
       roslaunch bin_picking_perception demo.launch rate:=10

Half of the calls wait for a new cloud, half take the latest one. Checked are: every call is answered, at least one with
grasps; each answer is of one cloud (the same stamp and frame in header, detections and grasps; the part in the hand is the
part where it was found); grasps have names that none had before; stage times are complete; the memory of the process
(VmRSS) grows by less than --max-growth to the last tenth of the calls from the last tenth of their first quarter (medians; at
least 20): before, caches, threads and pools come into being.
Exit code 0: all of this holds; 1: not, with a line for each fault.
"""
import argparse
import collections
import sys
import threading
import time
import xmlrpc.client

import numpy as np
import rosgraph
import rospy
from bin_picking_perception.msg import ReturnCode
from bin_picking_perception.srv import GetBestGrasp, GetBestGraspRequest, ReportPick, ReportPickRequest

START_TIME = 120  # seconds for the models and the first cloud


def process_of(node):
    """Process id of a node, from its own XML-RPC server."""
    uri = rosgraph.Master(rospy.get_name()).lookupNode(rospy.resolve_name(node))
    return xmlrpc.client.ServerProxy(uri).getPid(rospy.get_name())[2]


def resident_mib(process):
    with open(f"/proc/{process}/status") as status:
        return next(int(line.split()[1]) for line in status if line.startswith("VmRSS")) / 1024


def matrix(pose):
    p, q = pose.position, pose.orientation
    x, y, z, w = q.x, q.y, q.z, q.w
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), p.x],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), p.y],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), p.z],
                     [0, 0, 0, 1]])


def faults_of(answer):
    """What is wrong with one answer, in sentences."""
    if answer.code.value < 0:
        return [f"{answer.code.name}: {answer.code.message}"]
    faults = []
    key = (answer.header.stamp, answer.header.frame_id)
    for kind, messages in (("grasp", answer.grasps), ("detection", answer.detections)):
        if any((message.header.stamp, message.header.frame_id) != key for message in messages):
            faults.append(f"a {kind} is of another cloud or frame than its answer")
    if bool(answer.grasps) != (answer.code.value in (ReturnCode.OK, ReturnCode.PARTIAL)):
        faults.append(f"{len(answer.grasps)} grasps with the code {answer.code.name}")
    for grasp in answer.grasps:
        held = matrix(grasp.grasp) @ matrix(grasp.object_in_tip)
        if not np.allclose(held, matrix(answer.detections[grasp.detection_index].pose), atol=1e-6):
            faults.append("the part in the hand is not the part where it was found")
    stages = {time.stage: time.seconds for time in answer.timing}
    if answer.timing[-1].stage != "total" or not 0 < max(stages.values()) <= stages["total"] + 1e-6:
        faults.append(f"the stage times are not those of one call: {stages}")
    return faults


class Load:
    def __init__(self, detector, num_calls, process):
        self._name = detector + "/get_best_grasp"
        self._report = rospy.ServiceProxy(detector + "/report_pick", ReportPick)
        self._left = num_calls
        self._lock = threading.Lock()
        self.faults = collections.Counter()
        self.codes = collections.Counter()
        self.seconds = []
        self._process = process
        self.memory = []  # MiB, after each answer
        self._names = set()

    def run(self, num_clients):
        threads = [threading.Thread(target=self._client, args=(index,)) for index in range(num_clients)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()

    def _client(self, index):
        ask = rospy.ServiceProxy(self._name, GetBestGrasp)
        while self._take():
            request = GetBestGraspRequest(acquisition=(self._left + index) % 2, max_age=rospy.Duration(10))
            start = time.monotonic()
            try:
                self._note(ask(request), time.monotonic() - start)
            except rospy.ServiceException as problem:
                self._fault(f"a call was not answered: {problem}")
            except Exception as problem:  # whatever it is: the end of a thread would pass for calls without a fault
                self._fault(f"an answer could not be looked at: {type(problem).__name__}: {problem}")

    def _fault(self, text):
        with self._lock:
            self.faults[text] += 1

    def _take(self):
        with self._lock:
            self._left -= 1
            return self._left >= 0 and not rospy.is_shutdown()

    def _note(self, answer, seconds):
        faults = faults_of(answer)
        names = [grasp.uid for grasp in answer.grasps]
        with self._lock:
            if len(set(names)) < len(names) or self._names & set(names):
                faults.append("a grasp has a name that was given before")
            self._names.update(names)
            self.codes[answer.code.name] += 1
            self.seconds.append(seconds)
            self.memory.append(resident_mib(self._process))
            self.faults.update(faults)
        if names:  # picked: clears, so that the next answers have grasps too
            report = self._report(ReportPickRequest(grasp_uid=names[0], outcome=ReportPickRequest.PICKED))
            if report.code.value < 0:
                self._fault(f"{report.code.name} for a grasp just given")


def wait_until_ready(detector):
    ask = rospy.ServiceProxy(detector + "/get_best_grasp", GetBestGrasp)
    rospy.wait_for_service(detector + "/get_best_grasp", timeout=START_TIME)
    end = time.monotonic() + START_TIME
    answer = ask(GetBestGraspRequest())
    while answer.code.value < 0 and time.monotonic() < end:
        time.sleep(0.5)
        answer = ask(GetBestGraspRequest())
    if answer.code.value < 0:
        raise rospy.ROSException(f"{answer.code.name}: {answer.code.message}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--calls", type=int, default=1000)
    parser.add_argument("--clients", type=int, default=2)
    parser.add_argument("--detector", default="detector", help="name of the detector's node")
    parser.add_argument("--process", help="name of the node whose memory is looked at, e.g. the nodelet manager;"
                                          " default: the detector")
    parser.add_argument("--max-growth", type=float, default=16, help="of the memory, MiB")
    arguments = parser.parse_args(rospy.myargv()[1:])

    rospy.init_node("service_load", anonymous=True)
    wait_until_ready(arguments.detector)
    process = process_of(arguments.process or arguments.detector)
    num_last = max(20, arguments.calls // 10)
    num_first = max(num_last, arguments.calls // 4)
    first = Load(arguments.detector, num_first, process)
    first.run(arguments.clients)
    load = Load(arguments.detector, arguments.calls - num_first, process)
    load.run(arguments.clients)
    # Each cloud on its way takes tens of MiB for a moment: of many looks the middle one.
    before = float(np.median(first.memory[-num_last:] or [0]))
    growth = float(np.median(load.memory[-num_last:] or [0])) - before

    faults = first.faults + load.faults
    if growth > arguments.max_growth:
        faults[f"the memory grew by {growth:.1f} MiB, at most {arguments.max_growth:.1f} are allowed"] += 1
    num_answers = len(first.seconds) + len(load.seconds)
    if num_answers < arguments.calls:
        faults[f"{num_answers} answers came to {arguments.calls} calls"] += 1
    if not (first.codes + load.codes)["OK"]:
        faults["no answer was OK, so that no grasp was looked at: put parts into the view"] += 1
    seconds = np.array(load.seconds or [0])
    print(f"{num_answers} answers to {arguments.clients} clients: "
          + ", ".join(f"{count} {code}" for code, count in (first.codes + load.codes).items())
          + f"; median {np.median(seconds):.3f} s, slowest {seconds.max():.3f} s;"
          f" memory {before:.1f} MiB, grown by {growth:.1f} MiB over {len(load.seconds)} calls")
    for fault, count in faults.items():
        print(f"FAULT ({count}x): {fault}")
    return 1 if faults else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except (rospy.ROSException, rospy.ServiceException) as problem:
        sys.exit(f"service_load: {problem}")
