"""Reads result folders. What a folder lacks, a file or a column of a newer schema, is NaN."""
import json
import os

import pandas

KERNELS = ["generate", "trace", "shade", "trace_shadow"]
CATEGORIES = ["compute", "compute_stall", "memory_stall", "other"]
CELL = ["scene", "width", "height", "depth", "aa", "light_samples", "tile"]

# Columns that sections rely on; results/README.md explains them.
KERNEL_COLUMNS = (
    CELL
    + """variant threads kernel bounce rays ns_per_ray ns_per_ray_lo ns_per_ray_hi
    share_pct note flags reflection_rays refraction_rays instructions_per_ray l1d_misses_per_ray
    llc_misses_per_ray branch_misses_per_ray compute_pct compute_stall_pct memory_stall_pct
    other_pct counter_source category_source simulated_by nj_per_ray energy_source energy_note
    hardware_note nodes_per_ray boxes_per_ray spheres_per_ray triangles_per_ray cones_per_ray
    planes_per_ray lane_use_pct tree_bytes_per_ray primitive_bytes_per_ray schema_version""".split()
)
FRAME_COLUMNS = (
    CELL
    + """variant threads n repetitions frame_ms frame_ms_lo frame_ms_hi mdape_pct
    mrays_per_s imbalance build_ms tree_bytes primitives rays image_hash hits_hash flags note
    frame_j edp_js energy_source energy_note schema_version""".split()
)
SAMPLE_COLUMNS = CELL + "variant threads process repetition kernel bounce ns wall_ns".split()
VERSUS_COLUMNS = """scene rays threads row embree_mode mrays_ours mrays_embree ratio ratio_lo
    ratio_hi build_ns_ours build_ns_embree bytes_per_primitive_ours bytes_per_primitive_embree
    least_ns_per_ray""".split()
TEXT = set(
    """scene variant kernel note flags counter_source category_source simulated_by
    energy_source energy_note hardware_note image_hash hits_hash rays_class row embree_mode
    cpu_model peak""".split()
)


def read_table(path, columns):
    """The table with at least these columns; empty where there is no file, or no table in it."""
    try:
        table = pandas.read_csv(path, dtype={name: str for name in TEXT}, on_bad_lines="skip")
    except (
        OSError,
        UnicodeDecodeError,
        pandas.errors.ParserError,
        pandas.errors.EmptyDataError,
    ):
        table = pandas.DataFrame()
    for name in columns:
        if name not in table:
            table[name] = pandas.Series("" if name in TEXT else float("nan"), index=table.index)
        elif name not in TEXT and name != "rays":
            table[name] = pandas.to_numeric(table[name], errors="coerce")
    for name in TEXT & set(table.columns):
        table[name] = table[name].fillna("")
    return table


def ordered(values):
    """Without repetitions, in the order in which they come."""
    return list(dict.fromkeys(values))


class Result:
    """A result folder. Its tables are data frames."""

    def __init__(self, folder):
        def path(name):
            return os.path.join(folder, name)

        self.folder = folder
        self.kernels = read_table(path("kernels.csv"), KERNEL_COLUMNS)
        self.frames = read_table(path("frame.csv"), FRAME_COLUMNS)
        self.samples = read_table(path("samples.csv"), SAMPLE_COLUMNS)
        self.versus = read_table(path("versus.csv"), VERSUS_COLUMNS)
        self.peaks = read_table(path("peaks.csv"), ["cpu_model", "peak", "bytes", "per_ns"])
        for table in (self.kernels, self.frames):
            table["rays"] = pandas.to_numeric(table["rays"], errors="coerce")
        unavailable = self.frames["note"] == "unavailable"
        self.unavailable = ordered(self.frames.loc[unavailable, "variant"])
        self.frames = self.frames[~unavailable].copy()
        self.kernels = self.kernels[~self.kernels["variant"].isin(self.unavailable)].copy()
        try:
            with open(path("env.json"), encoding="utf-8") as file:
                self.env = json.load(file)
        except (OSError, ValueError):
            self.env = {}
        for table in (self.kernels, self.frames, self.samples):
            table["row"] = [row_name(v, t) for v, t in zip(table["variant"], table["threads"])]

    def fact(self, *path, default=None):
        """A member of env.json; `default` where it is not there or null."""
        here = self.env
        for name in path:
            here = here.get(name) if isinstance(here, dict) else None
        return default if here is None else here

    @property
    def made(self):
        """Where, of what and when these results were made."""
        return "%s, commit %s, %s" % (
            self.fact("host", "cpu_model", default="unknown machine"),
            str(self.fact("git", "commit", default="unknown"))[:12],
            str(self.fact("started", default="unknown day"))[:10],
        )

    @property
    def scenes(self):
        return ordered(self.frames["scene"])

    @property
    def generated(self):
        """Are these generated scenes of several sizes?"""
        return (
            self.frames.loc[self.frames["scene"].str.fullmatch(r"[a-z]+\d+"), "scene"].nunique()
            > 2
        )

    @property
    def several_threads(self):
        counts = self.frames.groupby(["scene", "variant"])["threads"].nunique()
        return len(counts) > 0 and counts.max() > 1

    def timed(self, scene=None):
        """Frames that have a time, of one scene or all."""
        frames = self.frames[self.frames["frame_ms"].notna()]
        return frames if scene is None else frames[frames["scene"] == scene]

    def serial_rows(self, scene):
        """Rows of one thread, in the order of the run, but for naive."""
        variants = ordered(self.frames.loc[self.frames["scene"] == scene, "variant"])
        return [v for v in variants if v != "naive" and not v.endswith("+omp")]

    def fastest(self, scene, serial=True):
        """The fastest row of one thread, or of all; None where nothing has a time. A yardstick,
        whose image may differ, is none of ours."""
        frames = self.timed(scene)
        frames = frames[~frames["variant"].str.startswith("embree")]
        if serial:
            frames = frames[~frames["variant"].str.endswith("+omp")]
        return None if frames.empty else frames.loc[frames["frame_ms"].idxmin()]

    def places(self, scene, variant):
        """Lines of kernels.csv that are about a kernel at a bounce, of a row of one thread."""
        k = self.kernels[(self.kernels["scene"] == scene) & (self.kernels["variant"] == variant)]
        return k[k["kernel"].isin(KERNELS) & k["bounce"].notna()]

    def grid(self, scene, variant, column):
        """`column` with a line for each kernel and a column for each bounce."""
        places = self.places(scene, variant)
        return places.pivot_table(
            index="kernel", columns="bounce", values=column, aggfunc="first"
        ).reindex(KERNELS)


class Results:
    """All folders that were given: the first is what the report is about, any may have what is
    measured by itself."""

    def __init__(self, folders, table1, raybench):
        self.all = [Result(folder) for folder in folders]
        self.main = next(
            (r for r in self.all if not r.frames.empty and not r.generated), self.all[0]
        )
        self.table1 = read_table(table1, ["paper_s", "threads", "median_s"])
        self.raybench = raybench

    def first(self, wanted):
        """The first folder that has something; None where none has."""
        return next((result for result in self.all if wanted(result)), None)

    @property
    def command(self):
        """Makes the report again."""
        return "make report RESULTS='%s'" % " ".join(result.folder for result in self.all)

    @property
    def versus(self):
        has = self.first(lambda result: not result.versus.empty)
        return has.versus if has else self.main.versus


def row_name(variant, threads):
    """As a reader sees it: rows with threads say how many."""
    return "%s x%d" % (variant, threads) if threads > 1 else str(variant)


def number(value, digits=3):
    """`digits` significant digits, without exponents; "" where there is none."""
    if value is None or value != value:
        return ""
    if value == 0:
        return "0"
    text = "%.*g" % (digits, value)
    return "%.0f" % float(text) if "e" in text and abs(value) >= 1 else text
