"""What a section is made of, and how sections become HTML and Markdown."""
import base64
import dataclasses
import os
import re

import jinja2
import markupsafe

HERE = os.path.dirname(os.path.abspath(__file__))


@dataclasses.dataclass
class Figure:
    """A drawing. `alt` says in words what it shows."""

    name: str
    svg: str
    alt: str
    caption: str = ""
    kind = "figure"

    @property
    def files(self):
        return [(self.name + ".svg", self.svg)]

    @property
    def inline(self):
        return self.svg[self.svg.index("<svg") :]


@dataclasses.dataclass
class Pictures:
    """Groups of pictures that belong side by side: [[(name, bytes of a PNG, alt, caption)]]."""

    groups: list
    kind = "pictures"

    @property
    def items(self):
        return [item for group in self.groups for item in group]

    @property
    def files(self):
        return [(name + ".png", png) for name, png, _, _ in self.items]


@dataclasses.dataclass
class Table:
    """Texts or numbers, as they are to be read."""

    head: list
    rows: list
    caption: str = ""
    folded: bool = False  # a long one, which people open if they want it
    kind = "table"
    files = ()

    @property
    def numeric(self):
        """Which columns hold numbers, and stand to the right."""
        return [
            all(is_number(row[i]) for row in self.rows if row[i]) for i in range(len(self.head))
        ]


@dataclasses.dataclass
class Code:
    text: str
    kind = "code"
    files = ()


@dataclasses.dataclass
class Section:
    """`finding` is one sentence computed from the data; `missing` says what could not be
    measured, and why."""

    name: str
    title: str
    finding: str
    blocks: list = dataclasses.field(default_factory=list)
    missing: list = dataclasses.field(default_factory=list)


def is_number(text):
    return bool(re.fullmatch(r"-?[\d.]+(e[+-]?\d+)?( to [\d.]+)?", text))


def cell(text):
    """A cell of a Markdown table."""
    return str(text).replace("|", "\\|").replace("\n", " ")


def words(text):
    """Escapes, and turns `code` into code: sections write that much Markdown."""
    return markupsafe.Markup(
        re.sub(r"`([^`]*)`", r"<code>\1</code>", str(markupsafe.escape(text)))
    )


def environment():
    env = jinja2.Environment(
        loader=jinja2.FileSystemLoader(HERE),
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        undefined=jinja2.StrictUndefined,
        autoescape=lambda name: bool(name) and ".html" in name,
    )
    env.filters["cell"] = cell
    env.filters["base64"] = lambda data: base64.b64encode(data).decode()
    env.filters["words"] = words
    return env


def render(template, **values):
    return environment().get_template(template).render(**values)


def write(path, content):
    """Whole or not at all."""
    mode, encoding = ("wb", None) if isinstance(content, bytes) else ("w", "utf-8")
    temporary = "%s.%d.tmp" % (path, os.getpid())
    try:
        with open(temporary, mode, encoding=encoding) as file:
            file.write(content)
        os.replace(temporary, path)
    finally:
        if os.path.exists(temporary):
            os.remove(temporary)
