"""Section 7: what rays move and test."""
import matplotlib

import draw
from data import number
from page import Figure, Section

TESTS = ["spheres_per_ray", "triangles_per_ray", "cones_per_ray", "planes_per_ray"]
BYTES = ["tree_bytes_per_ray", "primitive_bytes_per_ray"]
# What a line of panels shows: title, columns that are added up, of which kernel.
SHOWN = [
    ("nodes per ray", ["nodes_per_ray"]),
    ("primitive tests per ray", TESTS),
    ("bytes read per ray", BYTES),
    ("L1 misses per ray (simulated)", ["l1d_misses_per_ray"]),
    ("last-level misses per ray (simulated)", ["llc_misses_per_ray"]),
    ("lanes in use, %", ["lane_use_pct"]),
]


def lines_of(result, scene, columns):
    """[(row, bounces, values)] of trace."""
    for variant in result.serial_rows(scene):
        places = result.places(scene, variant)
        places = places[places["kernel"] == "trace"].sort_values("bounce")
        values = places[columns].sum(axis=1, min_count=1)
        if values.notna().any():
            yield variant, places["bounce"], values


def figure_of(result, title, columns, name):
    scenes, said = result.scenes, []
    figure, axes = draw.panels(1, len(scenes), 1.9, 2.1)
    rows = max((result.serial_rows(s) for s in scenes), key=len)
    for axis, scene in zip(axes[0], scenes):
        for variant, bounce, values in lines_of(result, scene, columns):
            i = rows.index(variant) if variant in rows else len(rows)
            axis.plot(
                bounce,
                values,
                color=draw.colour(i),
                marker=draw.marker(i),
                markersize=4,
                label=variant,
            )
            said.append(
                "%s %s %s to %s" % (scene, variant, number(values.min()), number(values.max()))
            )
        axis.set(title=scene, xlabel="bounce", ylim=(0, None))
        axis.xaxis.set_major_locator(matplotlib.ticker.MaxNLocator(integer=True))
    axes[0][0].set_ylabel(title.replace(" (simulated)", ""))
    handles = {
        label: handle
        for axis in axes[0]
        for handle, label in zip(*axis.get_legend_handles_labels())
    }
    if not said:
        draw.plot.close(figure)
        return None
    draw.legend(figure, handles.values(), handles.keys())
    return Figure(
        name,
        draw.finish(figure, name),
        "%s, trace: %s" % (title, "; ".join(said)),
        "%s, of trace, by bounce." % title,
    )


def section(results):
    result, blocks, missing = results.main, [], []
    for title, columns in SHOWN:
        figure = (
            figure_of(result, title, columns, "moved-" + columns[0].split("_")[0])
            if result.scenes
            else None
        )
        if figure:
            blocks.append(figure)
        else:
            missing.append(
                "%s: not %s." % (title, "simulated" if "simul" in title else "counted")
            )
    k = result.kernels[
        result.kernels["kernel"].eq("trace")
        & result.kernels["bounce"].notna()
        & ~result.kernels["variant"].str.endswith("+omp")
    ]
    finding = "Nothing was counted."
    if k["lane_use_pct"].notna().any():
        simd = k[~k["variant"].isin(("naive", "bvh")) & k["lane_use_pct"].notna()]
        first = simd[simd["bounce"] == 0]["lane_use_pct"].mean()
        last = simd[simd["bounce"] == simd["bounce"].max()]["lane_use_pct"].mean()
        per_ray = k.loc[k["nodes_per_ray"].idxmax()]
        finding = "A ray visits up to %s nodes (%s, %s, bounce %d)%s." % (
            number(per_ray["nodes_per_ray"]),
            per_ray["scene"],
            per_ray["variant"],
            per_ray["bounce"],
            "; SIMD rows use %s %% of their lanes at the camera, %s %% at the last bounce (means)"
            % (number(first), number(last))
            if first == first
            else "",
        )
    return Section("movement", "Data movement", finding, blocks, missing)
