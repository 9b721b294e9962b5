"""Section 11: the pipeline with measured shares (the paper's Figure 3), a tree of rays (its 1)."""
import re

from matplotlib.patches import FancyArrowPatch, FancyBboxPatch

import draw
from data import number
from kernels import shares
from page import Figure, Section
from pictures import run

# Stages: kernel, what it does, where it stands.
STAGES = [
    ("generate", "camera rays", (0, 1)),
    ("trace", "closest hits", (1, 1)),
    ("shade", "light, new rays", (2, 1)),
    ("trace_shadow", "is a light hidden?", (3, 1)),
    ("resolve", "light to pixels", (4, 1)),
]
WIDTH, HEIGHT = 0.82, 0.5


def box(axis, at, text, fill):
    axis.add_patch(
        FancyBboxPatch(
            (at[0], at[1]),
            WIDTH,
            HEIGHT,
            boxstyle="round,pad=0.02",
            facecolor=fill,
            edgecolor=draw.INK,
            linewidth=1,
        )
    )
    axis.text(
        at[0] + WIDTH / 2, at[1] + HEIGHT / 2, text, ha="center", va="center", fontsize=8.5
    )


def arrow(axis, start, end, **options):
    axis.add_patch(
        FancyArrowPatch(
            start,
            end,
            arrowstyle="-|>",
            mutation_scale=10,
            color=draw.INK,
            linewidth=1,
            **options,
        )
    )


def pipeline_figure(result, scene, variants):
    figure, axes = draw.panels(1, 1, 8, 2.6)
    axis, said = axes[0][0], []
    parts = [(v, shares(result, scene, v)) for v in variants]
    for kernel, does, at in STAGES:
        percent = "\n".join("%s %%  %s" % (number(part[kernel], 2), v) for v, part in parts)
        box(axis, at, "%s\n%s" % (kernel, does), draw.PAPER)
        axis.text(at[0] + WIDTH / 2, at[1] - 0.08, percent, ha="center", va="top", fontsize=7.5)
        said.append("%s %s" % (kernel, percent.replace("\n", ", ")))
    for (_, _, a), (_, _, b) in zip(STAGES, STAGES[1:]):
        arrow(axis, (a[0] + WIDTH + 0.03, 1 + HEIGHT / 2), (b[0] - 0.03, 1 + HEIGHT / 2))
    arrow(
        axis,
        (2 + WIDTH / 2, 1 + HEIGHT + 0.03),
        (1 + WIDTH / 2, 1 + HEIGHT + 0.03),
        connectionstyle="arc3,rad=0.5",
    )
    axis.text(
        2 - 0.09, 2.02, "reflected and refracted rays: the next bounce", ha="center", fontsize=8
    )
    axis.set(xlim=(-0.05, 5), ylim=(0.4, 2.2))
    axis.axis("off")
    return Figure(
        "pipeline",
        draw.finish(figure, "pipeline"),
        "Pipeline: generate, trace, shade, trace_shadow, resolve. Shares on %s: %s"
        % (scene, "; ".join(said)),
        "A batch of rays goes from kernel to kernel; percent of the frame on %s." % scene,
    )


def parse_tree(text):
    """[(parent or -1, kind, bounce, weight, what it hits)] of what `raybench pixel` prints."""
    nodes, path = [], []
    for line in text.splitlines():
        ray = re.match(
            r"( *)(camera|reflected|refracted) ray, bounce (\d+), weight ([\d.e+-]+)", line
        )
        if ray:
            bounce = int(ray[3])
            del path[bounce:]
            nodes.append([path[-1] if path else -1, ray[2], bounce, float(ray[4]), "misses"])
            path.append(len(nodes) - 1)
        elif nodes and (hit := re.match(r" *hits (\w+ \d+)", line)):
            nodes[-1][4] = hit[1]
    return nodes


def tree_figure(text, scene, x, y):
    nodes = parse_tree(text)
    leaves, place = 0, {}
    for i in range(len(nodes) - 1, -1, -1):  # children come after their parents
        children = [place[c] for c in place if nodes[c][0] == i]
        place[i] = sum(children) / len(children) if children else leaves
        leaves += not children
    figure, axes = draw.panels(
        1, 1, max(4, min(10, 0.9 * leaves)), 1 + 0.62 * (1 + max(n[2] for n in nodes))
    )
    axis, styles = axes[0][0], {
        "camera": (2, "-"),
        "reflected": (0, "-"),
        "refracted": (5, "--"),
    }
    for i, (parent, kind, bounce, weight, hit) in enumerate(nodes):
        colour, line = styles[kind]
        if parent >= 0:
            axis.plot(
                [place[parent], place[i]],
                [-nodes[parent][2], -bounce],
                line,
                zorder=0,
                color=draw.colour(colour),
                linewidth=0.7 + 2 * weight**0.5,
            )
        axis.plot(place[i], -bounce, "o", color=draw.colour(colour), markersize=6)
        axis.text(place[i], -bounce - 0.14, hit, ha="center", va="top", fontsize=6.5)
    for kind, (colour, line) in styles.items():
        axis.plot([], [], line, color=draw.colour(colour), label=kind + " ray")
    deepest = max(n[2] for n in nodes)
    axis.set(
        yticks=range(-deepest, 1),
        yticklabels=range(deepest, -1, -1),
        ylabel="bounce",
        xticks=[],
        ylim=(-deepest - 0.5, 0.4),
        xlim=(-0.6, max(place.values()) + 0.6),
    )
    axis.spines["bottom"].set_visible(False)
    draw.legend(figure, *axis.get_legend_handles_labels())
    return Figure(
        "rays",
        draw.finish(figure, "rays"),
        "The tree of %d rays of pixel (%d, %d) of %s, up to bounce %d"
        % (len(nodes), x, y, scene, deepest),
        "Rays of pixel (%d, %d) of %s; lines are as thick as the ray counts." % (x, y, scene),
    )


def section(results):
    result, blocks, missing = results.main, [], []
    finding = "Shares were not measured."
    scenes = [s for s in result.scenes if result.fastest(s) is not None]
    if scenes:
        scene = "balls_high" if "balls_high" in scenes else scenes[-1]
        best = result.fastest(scene)["variant"]
        variants = list(
            dict.fromkeys([v for v in ("bvh",) if v in result.serial_rows(scene)] + [best])
        )
        blocks.append(pipeline_figure(result, scene, variants))
        part = shares(result, scene, best)
        finding = (
            "On %s, %s spends %s %% of a frame in trace and trace_shadow, %s %% in shade."
            % (scene, best, number(part["trace"] + part["trace_shadow"]), number(part["shade"]))
        )
    else:
        missing.append("Shares: nothing has a time.")
    text, problem = run(results.raybench, "pixel", "mount_low", "250", "250", "--depth", "4")
    if problem:
        missing.append("A tree of rays: %s" % problem)
    else:
        blocks.append(tree_figure(text, "mount_low", 250, 250))
    return Section("pipeline", "The pipeline, and one pixel's rays", finding, blocks, missing)
