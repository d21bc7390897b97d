# SPDX-License-Identifier: BSD-3-Clause
# SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
"""Bins that were not made by the simulation: the real elbows as a data set of the own format, and the user's own."""
import dataclasses
import json
import os
import pathlib

import yaml

# The elbow equals itself after a half turn about the bisector of its two bores.
ELBOW = """format: 1
name: elbow
mesh: {file: Pipe_02.stl, unit: mm}
symmetry:
  discrete:
    - {axis: [0, 1, 1], order: 2, origin: [0.0206, 0, 0]}
"""


def read_yaml(path):
    return yaml.safe_load(pathlib.Path(path).read_text(encoding="utf-8"))


def link(source, target):
    if not target.exists():
        os.symlink(pathlib.Path(source).resolve(), target)


def write_dataset(pipes, folder):
    """The silver poses name only some of the elbows: recall of those can be told, wrong poses cannot."""
    part = folder / "parts" / "elbow"
    part.mkdir(parents=True, exist_ok=True)
    (part / "part.yaml").write_text(ELBOW, encoding="utf-8")
    link(pipes / "Pipe_02.stl", part / "Pipe_02.stl")
    for truth in sorted(pipes.glob("pipes_90_*.json")):
        scene = folder / truth.stem
        scene.mkdir(exist_ok=True)
        link(truth.with_suffix(".pcd"), scene / "scene.pcd")
        instances = [{"part": "elbow", "T_camera_object": instance["T_camera_object"],
                      "visible_fraction": instance.get("visible_within_3mm", 1.0)}
                     for instance in json.loads(truth.read_text(encoding="utf-8"))["instances"]]
        text = json.dumps({"format": 1, "parts": ["elbow"], "instances": instances})
        (scene / "truth.json").write_text(text, encoding="utf-8")
    return folder


@dataclasses.dataclass
class Scene:
    name: str
    dataset: str
    max_scenes: int  # 0: all


def scenes_of(dataset, split, most):
    """A cell per scene folder of the own format; one cell for a data set of the BOP benchmark."""
    path = pathlib.Path(dataset)
    if not path.is_dir():
        raise OSError(f"--dataset {dataset} is no folder")
    folders = sorted(folder for folder in path.iterdir() if (folder / "scene.pcd").exists())
    if split or not folders:
        return [Scene(path.resolve().name, str(path.resolve()), most)]
    return [Scene(folder.name, str(folder.resolve()), 0) for folder in folders[:most]]
