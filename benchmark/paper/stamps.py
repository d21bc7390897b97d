# SPDX-License-Identifier: BSD-3-Clause
# SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
"""What a result was made from, and on what machine: results of other code, data or options never share a report."""
import functools
import hashlib
import json
import pathlib

LARGE = 64 << 10  # bytes; larger files of a data set are told apart by size and time, there may be gigabytes
PLACES = ("models", "picture")  # where things are kept says nothing about the result


def hashed(text):
    return hashlib.sha256(text if isinstance(text, bytes) else text.encode()).hexdigest()


@functools.lru_cache(maxsize=None)
def file_content(path):
    return hashed(pathlib.Path(path).read_bytes())


@functools.lru_cache(maxsize=None)
def folder_content(path):
    lines = []
    for file in sorted(pathlib.Path(path).rglob("*")):
        if file.is_file():
            about = file.stat()
            text = f"{about.st_size} {about.st_mtime_ns}" if about.st_size > LARGE else file_content(str(file))
            lines.append(f"{file.relative_to(path)} {text}")
    return hashed("\n".join(lines))


def content(path):
    return folder_content(str(path)) if pathlib.Path(path).is_dir() else file_content(str(path))


def dataset_content(folder, split):
    """Of the scene or data set and of the parts that belong to it, which lie beside or in it."""
    folder = pathlib.Path(folder)
    used = [folder / split, *sorted(folder.glob("models*"))] if split else [folder, folder.parent / "parts"]
    return [content(path) for path in used if path.exists()]


def resolved(node):
    """A specification with the content of every file that it names in place of the name."""
    if isinstance(node, dict):
        return {key: dataset_content(value, node.get("split", "")) if key == "dataset" else resolved(value)
                for key, value in node.items() if key not in PLACES}
    if isinstance(node, list):
        return [resolved(value) for value in node]
    if isinstance(node, str) and node.startswith("/") and pathlib.Path(node).exists():
        return content(node)
    return node


def digest(cell):
    """Of all that a result follows from but the code."""
    return hashed(json.dumps(resolved(cell.specification), sort_keys=True))


def file_of(out, name):
    return out / "cells" / f"{name}.done"


def read(out, name):
    """What is known of a result; nothing if it was not finished."""
    try:
        return json.loads(file_of(out, name).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}


def write(out, name, about):
    file_of(out, name).write_text(json.dumps(about, indent=1), encoding="utf-8")


def code_of(out, cells, code, report_only):
    """The code whose results a report shows: this one, or where nothing is run and this one has none, the latest."""
    stamps = [stamp for stamp in (read(out, cell.name) for cell in cells) if stamp]
    if not report_only or not stamps or any(stamp["code"] == code for stamp in stamps):
        return code
    return max(stamps, key=lambda stamp: stamp["finished"])["code"]


def texts(stamps, key):
    return ", ".join(sorted({str(stamp.get(key) or "unknown") for stamp in stamps}))


def worst(stamps, key):
    return max((stamp[key] for stamp in stamps if stamp.get(key) is not None), default=0.0)


def sentence(stamps):
    """Version, machine and load of some results."""
    if not stamps:
        return ""
    unknown = sum(stamp.get("others_busy") is None for stamp in stamps)
    return (f"version {texts(stamps, 'version')}; {texts(stamps, 'processor')}, {texts(stamps, 'processors')}"
            f" processors, {texts(stamps, 'jobs')} experiment(s) at once; load before it {worst(stamps, 'load'):.1f},"
            f" others kept {worst(stamps, 'others_busy'):.1f} processors busy" +
            (f" (not measured for {unknown} of {len(stamps)} experiments: the run was broken off)" if unknown else ""))
