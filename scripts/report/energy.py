"""Section 6: energy per ray."""
from data import number, ordered
from kernels import heat_figure
from page import Section, Table


def section(results):
    result, blocks = results.main, []
    frames = result.frames[result.frames["frame_j"].notna()]
    sources = sorted(set(frames["energy_source"]) - {""})
    measured = any(not source.startswith("model") for source in sources)
    missing = [
        "%s: %s." % (note, ", ".join(ordered(rows["row"])))
        for note, rows in result.frames.groupby("energy_note")
        if note
    ]
    if not measured:
        missing.append(
            "Joules: not measured; `--energy` needs RAPL%s."
            % (
                ", which this machine does not offer"
                if result.fact("counters", "rapl_perf") is False
                else ""
            )
        )
    if frames.empty and result.kernels["nj_per_ray"].isna().all():
        missing.append(
            "Modelled energy: `--energy-model horowitz14-45nm`, from simulated events."
        )
        return Section(
            "energy", "Energy per ray", "No energy was measured or modelled.", [], missing
        )
    label = ", ".join(sources) or "unlabelled"
    for scene in result.scenes:
        figure = heat_figure(
            result,
            scene,
            result.serial_rows(scene),
            "nj_per_ray",
            "nJ per ray (%s)" % label,
            "nj-" + scene,
        )
        if figure:
            blocks.append(figure)
    lines = [
        [f.scene, f.row, number(f.frame_j), number(f.edp_js), f.energy_source]
        for f in frames.itertuples()
    ]
    blocks.append(
        Table(
            ["scene", "row", "J a frame", "J s (energy-delay product)", "source"],
            lines,
            folded=len(lines) > 12,
        )
    )
    finding = "Energy is given as %s." % label
    gains = []
    for scene in result.scenes:
        ours = frames[
            (frames["scene"] == scene) & ~frames["variant"].str.endswith("+omp")
        ].set_index("variant")
        best = result.fastest(scene)
        if "bvh" in ours.index and best is not None and best["variant"] in ours.index:
            gains.append(ours.loc["bvh", "frame_j"] / ours.loc[best["variant"], "frame_j"])
    if gains:
        finding = (
            "The fastest row takes 1/%s to 1/%s of the energy of bvh for the same frame, %s (%s)."
            % (
                number(min(gains), 2),
                number(max(gains), 2),
                "as measured" if measured else "as a model has it, good for ratios alone",
                label,
            )
        )
    return Section("energy", "Energy per ray", finding, blocks, missing)
