"""Makes the site of the pages of the project: see `mkdocs.yml`.

The pages are written for the folder of the project, where a page of `docs` names an example `../examples/…`. In the site the folder
`docs` is the root. So the README becomes the first page, the pages of the examples come into a folder `examples`, and all other files
that a page names, such as sources, into a folder `files`.
"""

import re
from pathlib import Path
from posixpath import dirname, join, normpath, relpath
from urllib.parse import unquote

from mkdocs.plugins import get_plugin_logger
from mkdocs.structure.files import File

# a warning fails the strict build
LOG = get_plugin_logger("site")
PROJECT = Path(__file__).resolve().parent.parent
FENCE = re.compile(r"^( *)(```+)(.*)$")
# a link or a picture whose target is no address: `](`, the path, then `)` or a heading
LINK = re.compile(r"(\]\()([^)#\s:]+)(?=[#)])")
CODE = re.compile(r"(`+).*?\1")


def in_site(path):
    """The place in the site of a file of the project."""
    if path == "README.md":
        return "index.md"
    if path.startswith("docs/"):
        return path.removeprefix("docs/")
    return path if re.fullmatch(r"examples/\w+/README\.md", path) else f"files/{path}"


def rewritten(text, path):
    """A page of the project with links as in the site, and the files of the project that it names."""
    named, lines, inside = set(), [], ""

    def led(link):
        target = normpath(join(dirname(path), unquote(link[2])))
        named.add(target)
        return link[1] + relpath(in_site(target), dirname(in_site(path)) or ".")

    def prose(line):
        """The line with its links rewritten outside of code."""
        done, at = "", 0
        for code in CODE.finditer(line):
            done, at = done + LINK.sub(led, line[at : code.start()]) + code[0], code.end()
        return done + LINK.sub(led, line[at:])

    for line in text.splitlines():
        fence = FENCE.match(line)
        if fence and not inside:
            inside = fence[2]
            if fence[1]:
                LOG.warning("%s: a block of code inside of a list is no block in the site: put it after the list", path)
            # Markdown of Python takes the language alone, and not the name of a file after it
            line = fence[1] + fence[2] + (fence[3].split() or [""])[0]
        elif fence and fence[2] == inside and not fence[3]:
            inside = ""
        elif not inside:
            line = prose(line)
        lines.append(line)
    return "\n".join(lines) + "\n", named


def heading(text, _separator):
    """The anchor of a heading, as GitHub makes it."""
    return re.sub(r"[^\w\- ]", "", text.strip().lower()).replace(" ", "-")


def on_config(config):
    config.mdx_configs["toc"] = {**config.mdx_configs.get("toc", {}), "slugify": heading}
    gallery = (PROJECT / "docs/gallery.md").read_text(encoding="utf-8")
    examples = dict.fromkeys(re.findall(r"\.\./examples/(\w+)/README\.md", gallery))
    pages = [{name: f"examples/{name}/README.md"} for name in examples]
    config.nav = [{"Examples": pages} if "Examples" in part else part for part in config.nav]
    return config


def on_files(files, config):
    pages = [PROJECT / "README.md", *PROJECT.glob("docs/**/*.md"), *PROJECT.glob("examples/*/README.md")]
    others = set()
    for page in pages:
        path = page.relative_to(PROJECT).as_posix()
        text, named = rewritten(page.read_text(encoding="utf-8"), path)
        written = files.get_file_from_path(in_site(path))
        if written:
            files.remove(written)
        files.append(File.generated(config, in_site(path), content=text))
        others |= named
    for path in others:
        # a target that is missing stays missing, so that the strict build fails
        if in_site(path).startswith("files/") and (PROJECT / path).is_file():
            files.append(File.generated(config, in_site(path), abs_src_path=str(PROJECT / path)))
    return files
