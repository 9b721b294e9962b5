"""How figures look: one palette, both colour schemes, the same file every time."""
import io
import re

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plot

# Okabe and Ito's palette: told apart by the colour-blind, and by their greys.
PALETTE = [
    "#0072b2",
    "#e69f00",
    "#009e73",
    "#cc79a7",
    "#56b4e9",
    "#d55e00",
    "#f0e442",
    "#999999",
]
MARKERS = "osD^vPX*"
HATCH = "////"

# Colours of the page, which change with its colour scheme: matplotlib draws with the ones on the
# left, and the file gets variables instead.
INK, FAINT, PAPER = "#0a0b0c", "#0d0e0f", "#fafbfc"
SCHEME = {INK: "var(--ink)", FAINT: "var(--faint)", PAPER: "var(--paper)"}
STYLE = """<style>
svg.plot { --ink: #1c1e21; --faint: #c9ccd1; --paper: #ffffff }
@media (prefers-color-scheme: dark) {
  svg.plot { --ink: #e4e6ea; --faint: #4a4e55; --paper: #16181c } }
@media print { svg.plot { --ink: #000000; --faint: #bbbbbb; --paper: #ffffff } }
</style>"""

matplotlib.rcParams.update(
    {
        "svg.fonttype": "none",
        "svg.hashsalt": "raybench",
        "font.size": 9,
        "font.family": "sans-serif",
        "axes.titlesize": 9,
        "axes.edgecolor": INK,
        "axes.labelcolor": INK,
        "text.color": INK,
        "xtick.color": INK,
        "ytick.color": INK,
        "axes.titlecolor": INK,
        "axes.facecolor": "none",
        "figure.facecolor": "none",
        "savefig.facecolor": "none",
        "legend.frameon": False,
        "axes.grid": False,
        "grid.color": FAINT,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "hatch.color": PAPER,
        "hatch.linewidth": 1.2,
        "axes.prop_cycle": matplotlib.cycler(color=PALETTE),
        "figure.constrained_layout.use": True,
    }
)


def colour(i):
    return PALETTE[i % len(PALETTE)]


def marker(i):
    return MARKERS[i % len(MARKERS)]


def panels(rows, columns, width, height):
    """A figure and its axes, always as a list of lists; sizes are those of a panel, in inches."""
    return plot.subplots(rows, columns, squeeze=False, figsize=(columns * width, rows * height))


def grid(count, columns, width, height):
    """`count` panels in lines of at most `columns`."""
    columns = min(columns, count)
    figure, axes = panels(-(-count // columns), columns, width, height)
    flat = [axis for line in axes for axis in line]
    for axis in flat[count:]:
        axis.set_visible(False)
    return figure, flat[:count]


def legend(figure, handles, labels, columns=4):
    figure.legend(
        handles,
        labels,
        loc="upper center",
        bbox_to_anchor=(0.5, 0),
        ncols=min(columns, len(labels)),
    )


def heat(axis, grid, norm, text, xlabels, ylabels):
    """A heat map with the numbers written in it; cells without one stay empty."""
    import numpy

    values = numpy.asarray(grid, dtype=float)
    cmap = matplotlib.colormaps["cividis"]
    axis.imshow(numpy.ma.masked_invalid(values), norm=norm, cmap=cmap, aspect="auto")
    axis.set_xticks(range(len(xlabels)), xlabels)
    axis.set_yticks(range(len(ylabels)), ylabels)
    axis.tick_params(length=0)
    axis.spines[:].set_visible(False)
    for y, line in enumerate(values):
        for x, value in enumerate(line):
            if value == value:
                dark = norm(value) < 0.55
                axis.text(
                    x,
                    y,
                    text(value),
                    ha="center",
                    va="center",
                    fontsize=7.5,
                    color="#ffffff" if dark else "#000000",
                )


def finish(figure, name):
    """The figure as SVG. Ids start with `name`, so that many fit into one page."""
    out = io.StringIO()
    figure.savefig(
        out, format="svg", bbox_inches="tight", metadata={"Date": None, "Creator": None}
    )
    plot.close(figure)
    svg = out.getvalue()
    for drawn, variable in SCHEME.items():
        svg = svg.replace(drawn, variable)
    svg = re.sub(r'\bid="', 'id="%s-' % name, svg)
    svg = re.sub(r'(xlink:href="#|url\(#)', r"\g<1>%s-" % name, svg)
    size = re.search(r'<svg[^>]*? width="([\d.]+)pt"', svg)
    svg = re.sub(r'(<svg[^>]*?) height="[\d.]+pt"', r"\1", svg, count=1)
    svg = re.sub(
        r'(<svg[^>]*?) width="[\d.]+pt"',
        r'\1 class="plot" width="%.0f"' % (float(size[1]) * 96 / 72),
        svg,
        count=1,
    )
    svg = re.sub(r"<metadata>.*?</metadata>\s*", "", svg, flags=re.DOTALL)
    return re.sub(r"(<svg[^>]*>)", lambda match: match[1] + "\n" + STYLE, svg, count=1)
