"""The report: one page that shows where the time goes, from result folders.

usage: scripts/report [-o FOLDER] [--raybench PROGRAM] [--table1 CSV] RESULT...

The first RESULT is what the report is about; the others add what is measured by itself: scaling,
threads, versus, peaks. FOLDER (report) gets report.html, which needs nothing else, report.md, and
the figures of the latter.
"""
import argparse
import importlib
import os
import sys

NEEDED = "python3-pandas python3-matplotlib python3-jinja2 python3-pil"
SECTIONS = [
    "verdict",
    "pictures",
    "times",
    "kernels",
    "categories",
    "energy",
    "movement",
    "scaling",
    "roofline",
    "samples",
    "pipeline",
    "machine",
]


def arguments():
    parser = argparse.ArgumentParser(prog="report", description=__doc__.split("\n\n")[0])
    parser.add_argument("results", nargs="+", metavar="RESULT", help="result folders")
    parser.add_argument("-o", dest="folder", default="report", help="where to write")
    parser.add_argument(
        "--raybench", default="build/raybench", help="draws scenes and trees of rays"
    )
    parser.add_argument("--table1", default="report/table1.csv", help="of `make table`")
    return parser.parse_args()


def write_all(folder, sections, **values):
    """The figures of these sections and no others, then the two pages that show them."""
    import page

    figures = os.path.join(folder, "figures")
    os.makedirs(figures, exist_ok=True)
    files = dict(
        file for section in sections for block in section.blocks for file in block.files
    )
    for name, content in files.items():
        page.write(os.path.join(figures, name), content)
    for name in set(os.listdir(figures)) - set(files):
        os.remove(os.path.join(figures, name))
    for name in ("report.html", "report.md"):
        text = page.render(name + ".j2", sections=sections, **values)
        page.write(os.path.join(folder, name), text)


def main():
    given = arguments()
    try:
        modules = [importlib.import_module(name) for name in SECTIONS]
        data = importlib.import_module("data")
        importlib.import_module("PIL")
    except ImportError as problem:
        sys.exit("report: %s; install it with: apt-get install %s" % (problem, NEEDED))
    results = data.Results(given.results, given.table1, given.raybench)
    if all(result.frames.empty for result in results.all):
        sys.exit(
            "report: %s: no frame.csv with any line; run make bench, or name a result folder"
            % " ".join(given.results)
        )
    sections = [module.section(results) for module in modules]
    try:
        write_all(given.folder, sections, made=results.main.made, command=results.command)
    except OSError as problem:
        sys.exit("report: %s" % problem)
    print("%s: %d sections" % (os.path.join(given.folder, "report.html"), len(sections)))


main()
