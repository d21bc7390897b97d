# SPDX-License-Identifier: BSD-3-Clause
# SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
"""What benchmark/paper.sh runs: every cell is one specification for the program benchmark_paper and one result file."""
import dataclasses
import pathlib

import real_bins

# Column of the paper, model file in DATA/stanford, constants in config/paper. Lucy stands in for the Thai statuette.
MODELS = [("Bunny", "stanford_bunny_100k.ply", "bunny"), ("Dragon", "dragon_100k.ply", "dragon"),
          ("Statuette", "lucy_100k.ply", "statuette"), ("Chinese_Dragon", "xyzrgb_dragon_100k.ply", "chinese_dragon"),
          ("Armadillo", "armadillo_100k.ply", "armadillo"), ("Buddha", "happy_100k.ply", "buddha")]
DIAGONAL = 0.25  # metres: every public model is scaled to it, so that the paper's millimetres mean something
# Of the Laser Scanner set only the parasaurolophus and one scan can be had; three other models fill the scenes.
LASER = [("Parasaurolophus", "uwa/parasaurolophus_low_normals2.ply"), ("Armadillo", "stanford/armadillo_100k.ply"),
         ("Bunny", "stanford/stanford_bunny_100k.ply"), ("Dragon", "stanford/dragon_100k.ply")]
PARTS = {"three_way_tube": (25, 5), "upright_column": (15, 3)}  # parts in a bin, best poses that are kept
NOISES = [0.1, 0.3, 0.5]     # of the mesh resolution, as the Retrieval set has them
SENSOR_NOISES = [0.0, 0.2, 0.4, 0.6]  # mm
GROUPS = ["retrieval", "bins", "real", "figures", "laser", "partial", "ablations"]
WEIGHTS = [1, 2, 3, 4, 6, 8]

TOP_CLUSTER = {"icp/method": "none", "clustering/max_clusters": "1"}
# Without candidates nothing says how many clusters are parts: the strongest two for each of 25.
WHOLE_SCENE = {"segmentation/method": "none", "segmentation/veto": "false", "clustering/max_clusters": "50"}


@dataclasses.dataclass
class Cell:
    """An experiment that is run once; its result is OUT/cells/NAME.json."""
    name: str
    group: str  # the table it belongs to
    specification: dict
    title: str


@dataclasses.dataclass
class Missing:
    """An experiment that cannot be run, and what it would need."""
    group: str
    reason: str


def method(name, config, feature, detector=None, training=None, **more):
    return {"name": name, "preset": "paper", "config": config, "detector": detector or {},
            "training": {"feature": feature, **(training or {})}, **more}


def in_inverse_millimetres(config):
    """The same numbers of a configuration, read as a mean curvature in 1/mm."""
    values = real_bins.read_yaml(config)["training"]
    return {"curvature_measure": "mean_curvature",
            **{key: str(values[key]).split("/")[0] + "/mm"
               for key in ("d_cur", "low_curvature_max", "high_curvature_min")}}


def retrieval_methods(config):
    other = in_inverse_millimetres(config)
    unweighted = {**TOP_CLUSTER, "voting/weight": "1"}  # as feature cur_ppf_unweighted; one training less
    return [method("PPF", config, "ppf", TOP_CLUSTER),
            method("Cur-PPF (unweighted)", config, "cur_ppf", unweighted),
            method("Cur-PPF", config, "cur_ppf", TOP_CLUSTER),
            method("Cur-PPF (unweighted), 1/mm", config, "cur_ppf", unweighted, other),
            method("Cur-PPF, 1/mm", config, "cur_ppf", TOP_CLUSTER, other)]


def partial_methods(config):
    """For scenes in which methods separate: also what repairs a curvature that falls into the next bin."""
    spread = {**TOP_CLUSTER, "voting/curvature_spread": "0.3"}
    automatic = {"curvature_measure": "mean_curvature", "d_cur": "0", "low_curvature_max": "0",
                 "high_curvature_min": "0"}
    paper = retrieval_methods(config)
    return [paper[0], paper[2], paper[4], method("Cur-PPF, spread 0.3", config, "cur_ppf", spread),
            method("Cur-PPF, bins from the part, spread 0.3", config, "cur_ppf", spread, automatic)]


def bin_methods(config):
    no_icp = {"icp/method": "none"}
    return [method("PPF", config, "ppf", {**WHOLE_SCENE, **no_icp}), method("Cur-PPF", config, "cur_ppf", no_icp),
            method("PPF + ICP", config, "ppf", WHOLE_SCENE), method("Cur-PPF + ICP", config, "cur_ppf"),
            method("PPF on the candidates", config, "ppf", no_icp),
            method("Cur-PPF on the whole scene", config, "cur_ppf", {**WHOLE_SCENE, **no_icp}),
            {"name": "our preset fast", "preset": "fast", "part_training": True}]


def ablation_methods(config):
    """Cur-PPF + ICP on the tube as in the paper, one thing at a time done otherwise: (ingredient, instead, method)."""
    def row(ingredient, instead, detector=None, training=None, feature="cur_ppf", **more):
        return ingredient, instead, method(f"{ingredient}: {instead}", config, feature, detector, training, **more)
    rows = [row("as in the paper", "Cur-PPF + ICP"),
            row("curvature measure", "none (PPF)", feature="ppf"),
            row("curvature measure", "normal variation, step 0.1", training={
                "curvature_measure": "normal_variation", "d_cur": "0.1", "low_curvature_max": "0.07",
                "high_curvature_min": "0.2"}),
            row("curvature measure", "mean curvature seen in views", training={"curvature_in_views": "true"})]
    rows += [row("d_cur", f"{step}/mm", training={"d_cur": f"{step}/mm"}) for step in (0.0125, 0.05, 0.1, 0.3)]
    rows += [row("number of bins", "from the part", training={"d_cur": "0", "curvature_in_views": "true"})]
    rows += [row("spread", str(spread), {"voting/curvature_spread": spread}) for spread in (0.3, 0.5)]
    rows += [row("spread", "0.3, and cut-off neighbourhoods vote in all bins",
                 {"voting/curvature_spread": 0.3, "voting/curvature_wildcard": "true"})]
    rows += [row("weight", str(weight), {"voting/weight": weight}) for weight in WEIGHTS if weight != 3]
    rows += [row("leaf", f"{leaf} mm", training={"leaf": f"{leaf}mm", "matching_leaf": f"{leaf}mm"})
             for leaf in (4, 5)]
    rows += [row("d_dist", f"{step} mm", training={"d_dist": f"{step}mm"}) for step in (1, 2.5)]
    rows += [row("reference share", f"1/{n}", {"voting/reference_share": 1 / n}) for n in (10, 20, 50)]
    rows += [row("segmentation", "off", {**WHOLE_SCENE, "voting/reference_share": 0.02}),
             row("segmentation", "depth edges", {"segmentation/method": "depth_edges"}),
             row("segmentation", "the true outlines", {"segmentation/method": "none", "segmentation/veto": "false"},
                 segments="true")]
    return rows


class Plan:
    """All cells of a run, and what is missing for the others."""

    def __init__(self, options, package, out):
        self.options = options
        self.package = pathlib.Path(package)
        self.out = pathlib.Path(out)
        self.cells = []
        self.missing = []
        self.trials = options.trials or (1 if options.quick else 2)
        self.views = 1 if options.quick else self.trials + 1  # motions per model in views, clutter and Table 5
        self.bins = options.bins or (2 if options.quick else 20)

    def config(self, name):
        return str(self.package / "config" / "paper" / f"{name}.yaml")

    def picture(self, name):
        return str(self.out / "pictures" / name)

    def add(self, name, group, title, **specification):
        self.cells.append(Cell(name, group, {"models": str(self.out / "models"), **specification}, title))

    def data(self, group, *names):
        """The files of the data folder, or nothing and a reason."""
        if not self.options.data:
            self.missing.append(Missing(group, "--data was not given; it needs in that folder " + ", ".join(names)))
            return None
        files = [pathlib.Path(self.options.data) / name for name in names]
        absent = [str(file) for file in files if not file.exists()]
        if absent:
            self.missing.append(Missing(group, "not there: " + ", ".join(absent)))
            return None
        return [str(file.resolve()) for file in files]

    def retrieval(self):
        files = self.data("retrieval", *(f"stanford/{file}" for _, file, _ in MODELS))
        if not files:
            return
        objects = [{"name": name, "file": file, "diagonal": DIAGONAL} for (name, _, _), file in zip(MODELS, files)]
        for k, (name, _, config) in enumerate(MODELS):
            config = self.config(config)
            others = objects[k + 1:] + objects[:k]
            self.add(f"whole_{name}", "retrieval", f"Tables 1-4: {name}", kind="points", objects=[objects[k]],
                     scene="whole", noise=NOISES, trials=self.trials, seed=100 * k + 1,
                     methods=retrieval_methods(config), picture=self.picture(f"whole_{name}"))
            for scene in ("view", "clutter"):
                self.add(f"{scene}_{name}", "partial", f"{scene}: {name}", kind="points",
                         objects=[objects[k]] + others[:4], scene=scene, noise=[0.1], trials=self.views,
                         seed=100 * k + 51, methods=partial_methods(config), picture=self.picture(f"{scene}_{name}"))
            self.add(f"curvature_{name}", "figures", f"Figure 12: {name}", kind="curvature", object=objects[k],
                     method=method("Cur-PPF", config, "cur_ppf"), picture=self.picture(f"curvature_{name}.png"))

    def laser_methods(self):
        config = self.config("dragon")
        icp = {"clustering/max_clusters": "1"}
        return [method("PPF", config, "ppf", TOP_CLUSTER), method("Cur-PPF", config, "cur_ppf", TOP_CLUSTER),
                method("PPF + ICP", config, "ppf", icp), method("Cur-PPF + ICP", config, "cur_ppf", icp),
                method("Cur-PPF + ICP, best of ten clusters", config, "cur_ppf"),
                method("Cur-PPF + ICP, best of ten clusters, spread 0.3", config, "cur_ppf",
                       {"voting/curvature_spread": "0.3"})]

    def laser(self):
        files = self.data("laser", *(file for _, file in LASER))
        if not files:
            return
        objects = [{"name": name, "file": file, **({"unit": "mm"} if "uwa" in file else {"diagonal": DIAGONAL})}
                   for (name, _), file in zip(LASER, files)]
        for k, item in enumerate(objects):
            self.add(f"laser_{item['name']}", "laser", f"Table 5: {item['name']}", kind="points",
                     objects=[item] + objects[k + 1:] + objects[:k], scene="clutter", noise=[0.1],
                     trials=self.views, seed=1001 + 100 * k, methods=self.laser_methods(),
                     picture=self.picture(f"laser_{item['name']}"))
        scan = self.data("laser", "uwa/rs1_normals.ply", "uwa/pseudo_gt_parasaurolophus_rs1.xf")
        if scan:
            self.add("laser_rs1", "laser", "Table 5: the real scan rs1", kind="points", objects=[objects[0]],
                     scene={"file": scan[0], "unit": "mm", "truth": scan[1]}, methods=self.laser_methods(),
                     picture=self.picture("laser_rs1"))

    def bin_sets(self):
        for part, (count, _) in PARTS.items():
            config = self.config(part)
            for k in range(self.bins):
                self.add(f"bins_{part}_{k + 1:02}", "bins", f"Tables 6-7: {part}, bin {k + 1}", kind="bins",
                         simulate=[str(self.package / "config" / "parts" / part), count, 9000 + k, []],
                         methods=bin_methods(config),
                         **({"picture": self.picture(f"bins_{part}")} if k == 0 else {}))
            self.add(f"segmentation_{part}", "figures", f"Figures 5 and 16: {part}", kind="segmentation", part=part,
                     simulate=[str(self.package / "config" / "parts" / part), count, 9000, []],
                     method=method("Cur-PPF", config, "cur_ppf", {"icp/method": "none"}),
                     picture=self.picture(f"segmentation_{part}"))
        for part in PARTS:
            self.add(f"curvature_{part}", "figures", f"Figure 7: {part}", kind="curvature",
                     object={"part": str(self.package / "config" / "parts" / part)},
                     method=method("Cur-PPF", self.config(part), "cur_ppf"),
                     picture=self.picture(f"curvature_{part}.png"))

    def ablations(self):
        part = str(self.package / "config" / "parts" / "three_way_tube")
        config = self.config("three_way_tube")
        scenes = self.options.ablation_bins or (1 if self.options.quick else 4)
        for k in range(scenes):
            self.add(f"ablation_{k + 1:02}", "ablations", f"ablations, bin {k + 1}", kind="bins",
                     simulate=[part, 25, 9000 + k, []],
                     methods=[entry[2] for entry in ablation_methods(config)])
        for noise in SENSOR_NOISES:
            for k in range(scenes):
                values = [f"sensor/noise/depth_noise={noise / 1000}"]
                self.add(f"noise_{noise}_{k + 1:02}", "ablations", f"noise {noise} mm, bin {k + 1}", kind="bins",
                         simulate=[part, 25, 9000 + k, values],
                         methods=[m for m in bin_methods(config) if m["name"] in (
                             "PPF on the candidates", "Cur-PPF", "Cur-PPF + ICP", "our preset fast")])

    def real(self):
        files = self.data("real", "pipes/Pipe_02.stl")
        if not files:
            return
        pipes = pathlib.Path(files[0]).parent
        clouds = [truth.with_suffix(".pcd") for truth in sorted(pipes.glob("pipes_90_*.json"))]
        absent = [str(cloud) for cloud in clouds if not cloud.exists()] if clouds else [f"{pipes}/pipes_90_*.json"]
        if absent:
            self.missing.append(Missing("real", "not there: " + ", ".join(absent)))
            return
        dataset = real_bins.write_dataset(pipes, self.out / "elbows")
        for scene in sorted(dataset.glob("pipes_*")):
            self.add(f"real_{scene.name}", "real", f"real elbows: {scene.name}", kind="bins", dataset=str(scene),
                     methods=bin_methods(self.config("three_way_tube")))

    def own(self):
        """The user's parts and clouds in place of ours."""
        config = self.options.config or self.config("three_way_tube")
        for scene in real_bins.scenes_of(self.options.dataset, self.options.split, self.bins):
            self.add(f"own_{scene.name}", "bins", f"Tables 6-7: {scene.name}", kind="bins", dataset=scene.dataset,
                     split=self.options.split, parts=self.options.parts, max_scenes=scene.max_scenes,
                     methods=bin_methods(config))
        own_parts = sorted(pathlib.Path(self.options.dataset).glob("parts/*/part.yaml"))
        if not own_parts:
            self.missing.append(Missing("retrieval", f"{self.options.dataset} has no parts/*/part.yaml, which single"
                                        " parts as point sets are made from"))
        for part in own_parts:
            name = part.parent.name
            if self.options.only and "retrieval" not in self.options.only:
                continue
            if self.options.parts and name not in self.options.parts:
                continue
            for scene, noise, methods in (("whole", NOISES, retrieval_methods(config)),
                                          ("view", NOISES[:1], partial_methods(config))):
                self.add(f"{scene}_{name}", "retrieval", f"{scene}: {name}", kind="points",
                         objects=[{"part": str(part.parent.resolve())}], scene=scene, noise=noise,
                         trials=self.trials, seed=1, methods=methods)


def make_plan(options, package, out):
    plan = Plan(options, package, out)
    if options.dataset:
        plan.own()
        plan.cells.sort(key=lambda cell: GROUPS.index(cell.group))
        return plan
    wanted = options.only or ["retrieval", "laser", "bins", "real", "ablations"]
    for name, step in (("retrieval", plan.retrieval), ("laser", plan.laser), ("bins", plan.bin_sets),
                       ("real", plan.real), ("ablations", plan.ablations)):
        if name in wanted:
            step()
    plan.cells.sort(key=lambda cell: GROUPS.index(cell.group))  # what the summary needs first
    return plan
