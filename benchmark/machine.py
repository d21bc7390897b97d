# SPDX-License-Identifier: BSD-3-Clause
# SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
"""The machine that figures were taken on, and how busy it was with other work."""
import os

BUSY_FIELDS = (0, 1, 2, 5, 6, 7)  # of /proc/stat: user, nice, system, interrupts and what a host took away
MAX_LOAD = 1.5                    # of one minute, before the first run
MAX_OTHERS = 0.3                  # processors that others kept busy during a run


def processor_name():
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        for line in file:
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    return "unknown processor"


def load_average():
    return os.getloadavg()[0]


def busy_seconds(stat_line):
    """Processor seconds since the machine started, from the first line of /proc/stat."""
    fields = stat_line.split()[1:]
    return sum(int(fields[i]) for i in BUSY_FIELDS) / os.sysconf("SC_CLK_TCK")


def busy_seconds_now():
    with open("/proc/stat", encoding="utf-8") as file:
        return busy_seconds(file.readline())


def busy_warning(load, others):
    """A paragraph if the figures cannot be trusted, else nothing."""
    if load <= MAX_LOAD and others <= MAX_OTHERS:
        return ""
    return (f"> **WARNING: the machine was busy with other work.** The load average before the first run was {load:.1f}"
            f" (limit {MAX_LOAD}), and others kept up to {others:.1f} processors busy during a run (limit"
            f" {MAX_OTHERS}). The times below are too long; run this again on a quiet machine.\n")
