# SPDX-License-Identifier: BSD-3-Clause
# SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
"""The table of what is tried in place of the default, checked against the parameters that there are."""
import difflib
import re
import subprocess

SETTING = re.compile(r"(?P<key>[a-z_]+/[a-z0-9_/]+)(?P<operator>[=*])(?P<value>\S+)")


class TableError(Exception):
    """A sentence for the user."""


class Variant:
    """A line of the table: its words, and the values that differ from the default."""

    def __init__(self, ingredient, instead):
        self.ingredient = ingredient
        self.instead = instead
        self.values = {}       # key: text
        self.leaf_factor = 1   # of the leaf that training derives for each part

    def title(self):
        return f"{self.ingredient}: {self.instead}"


def read_defaults(program, preset):
    """Every parameter of training and detection with its value, as `bin_picking parameters` prints them."""
    defaults = {}
    for command in (["--of", "train"], ["--preset", preset]):
        text = subprocess.run([program, "parameters", *command], check=True, capture_output=True, text=True).stdout
        group = ""
        for line in text.splitlines():
            if header := re.fullmatch(r"(\S+):", line):
                group = header[1]
            elif entry := re.match(r'  (\w+): "?([^"#]*?)"?  #', line):
                defaults[f"{group}/{entry[1]}"] = entry[2]
    return defaults


def is_same(a, b):
    try:
        return abs(float(a) - float(b)) <= 1e-9 * max(abs(float(a)), abs(float(b)))
    except ValueError:
        return a == b


def scaled(text, factor):
    value = float(text) * factor
    return str(round(value)) if re.fullmatch(r"\d+", text) else f"{value:.6g}"


def read_setting(text, defaults, where):
    match = SETTING.fullmatch(text)
    if not match:
        raise TableError(f"{where}: '{text}' is not a setting; write KEY=VALUE or KEY*FACTOR, for example"
                         " detector/voting/max_bucket=0.")
    key = match["key"]
    if key not in defaults:
        near = difflib.get_close_matches(key, defaults, 1)
        raise TableError(f"{where}: there is no parameter '{key}'" + (f"; did you mean '{near[0]}'?" if near else ".")
                         + " 'bin_picking parameters' and 'bin_picking parameters --of train' list them; correct the"
                         " line or delete it.")
    return key, match["operator"], match["value"]


def read_variant(line, defaults, where):
    """None if the line says what the default is anyway."""
    words = [word.strip() for word in line.split("|")]
    if len(words) != 3:
        raise TableError(f"{where}: '{line}' has {len(words)} columns, but there must be three: ingredient | what is"
                         " done instead | settings.")
    variant = Variant(words[0], words[1])
    for setting in words[2].split():
        key, operator, value = read_setting(setting, defaults, where)
        if operator == "*" and is_same(defaults[key], "0"):
            if key != "training/leaf":
                raise TableError(f"{where}: a multiple of '{key}' was asked for, but its default is 0; give a value.")
            variant.leaf_factor = float(value)
            continue
        variant.values[key] = value if operator == "=" else scaled(defaults[key], float(value))
    is_default = variant.leaf_factor == 1 and all(is_same(value, defaults[key])
                                                  for key, value in variant.values.items())
    return None if is_default else variant


def read_table(path, defaults):
    with open(path, encoding="utf-8") as file:
        lines = file.read().splitlines()
    variants = [read_variant(line, defaults, f"{path}, line {number}") for number, line in enumerate(lines, 1)
                if line.strip() and not line.startswith("#")]
    return [variant for variant in variants if variant]
