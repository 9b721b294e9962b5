"""Section 2: the scenes as pictures, beside what each pixel costs."""
import io
import os
import re
import subprocess
import tempfile

from data import number
from page import Pictures, Section

SIZE = 192


def run(raybench, *words):
    try:
        done = subprocess.run([raybench, *words], capture_output=True, text=True, timeout=300)
    except (OSError, subprocess.TimeoutExpired) as problem:
        return None, str(problem)
    return (done.stdout, None) if done.returncode == 0 else (None, done.stderr.strip())


def png(path):
    import PIL.Image

    out = io.BytesIO()
    PIL.Image.open(path).save(out, "png", optimize=True)
    return out.getvalue()


def pictures_of(raybench, scene, folder):
    """[(name, png, alt, caption)] of a scene, and where its pixels are dear; or what went wrong."""
    size = "%dx%d" % (SIZE, SIZE)
    image, heat = (os.path.join(folder, name) for name in ("image.ppm", "heat.ppm"))
    _, problem = run(raybench, "render", scene, "--size", size, "--quiet", "-o", image)
    if problem:
        return [], problem
    items = [(scene, png(image), "%s, rendered" % scene, scene)]
    said, problem = run(
        raybench,
        "count",
        scene,
        "--size",
        size,
        "--variant",
        "bvh",
        "--heatmap",
        "tests",
        "--out",
        folder,
        "-o",
        heat,
    )
    if problem:
        return items, problem
    scale = re.search(r"mean ([\d.e+]+); white is ([\d.e+]+)", said)
    caption = (
        "tests a pixel: mean %s, white %s and more"
        % tuple(number(float(x)) for x in scale.groups())
        if scale
        else "tests a pixel"
    )
    items.append((scene + "-tests", png(heat), "%s: %s" % (scene, caption), caption))
    return items, None


def section(results):
    groups, missing, means = [], [], {}
    with tempfile.TemporaryDirectory() as folder:
        for scene in results.main.scenes:
            made, problem = pictures_of(results.raybench, scene, folder)
            groups += [made] if made else []
            if problem:
                missing.append("%s: %s" % (scene, problem))
                continue
            mean = re.search(r"mean ([\d.]+)", made[-1][3])
            means[scene] = float(mean[1]) if mean else float("nan")
    finding = "No picture could be made."
    if means:
        dear, cheap = max(means, key=means.get), min(means, key=means.get)
        finding = (
            "A pixel of %s takes %s tests of primitives on average, one of %s %s; bright is dear."
            % (dear, number(means[dear]), cheap, number(means[cheap]))
        )
    return Section(
        "scenes",
        "The scenes, and what their pixels cost",
        finding,
        [Pictures(groups)] if groups else [],
        missing,
    )
