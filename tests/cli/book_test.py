"""./lab book: a site that a browser opens from disk without complaints."""

import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from urllib.parse import unquote

from tools_path import PROJECT, TOOLS  # first: it finds the others
import numpy as np
from book import search
from browser import CHROMIUM, Browser
from project import CHAPTERS

NARROW = 400  # pixels, the width of a phone
# For a page: the names that links may target, the targets of its own links, missing pictures, formulas that are not typeset, and
# what is wider than the screen and cannot be scrolled by itself.
INSPECT = r"""(() => {
    const text = document.querySelector("article").cloneNode(true);
    const scrolls = element => element && (/auto|scroll/.test(getComputedStyle(element).overflowX) || scrolls(element.parentElement));
    const isHidden = element => element.closest(".katex-mathml, .katex svg");  // what KaTeX cuts off
    const isTooWide = element => element.getBoundingClientRect().right > document.documentElement.clientWidth &&
        !scrolls(element) && !isHidden(element);
    text.querySelectorAll("code, .katex").forEach(element => element.remove());
    return {
        names: [...document.querySelectorAll("[id]")].map(element => element.id),
        links: [...document.querySelectorAll("a[href]")].map(link => link.href),
        pictures: [...document.images].filter(image => !image.naturalWidth).map(image => image.src),
        formulas: [...document.querySelectorAll(".katex-error")].map(error => error.title)
            .concat(text.textContent.match(/\$[^\s$][^$\n]*\$|\$\$|\\[([]|\\[a-z]{2,}/g) ?? []),
        wide: [...document.querySelectorAll("article *")].filter(isTooWide).map(element => element.outerHTML.slice(0, 80))
    };
})()"""
WIDE = 1280  # pixels
CUT_CODE = """[...document.querySelectorAll("pre > code")].filter(code => code.scrollWidth > code.clientWidth + 1)
    .map(code => code.textContent.slice(0, 80))"""
# What those miss who see no colours or have no mouse, and the colours of a comment and what is behind it.
MISSED = """(() => {
    const all = (selector, isMissed) => [...document.querySelectorAll(selector)].filter(element => isMissed(element, getComputedStyle(element)));
    return [...all("article a:not(.headerlink)", (link, style) => style.textDecorationLine !== "underline"),
            ...all("article p, article div", (element, style) => /auto|scroll/.test(style.overflowX) && element.scrollWidth > element.clientWidth && element.tabIndex !== 0),
            ...all("[role='dialog']", dialog => !dialog.ariaLabel), ...all(".md-search__output", (output, style) => style.visibility === "visible")]
        .map(element => element.outerHTML.slice(0, 80));
})()"""
COLOURS = """[getComputedStyle(document.querySelector(".c1")).color, getComputedStyle(document.querySelector("pre > code")).backgroundColor]"""
LEAST_CONTRAST = 4.5
SEARCH = r"""new Promise((found, failed) => {
    document.querySelector("#__search").click();
    const input = document.querySelector(".md-search__input"), results = document.querySelector(".md-search-result__list");
    const titles = () => [...results.querySelectorAll("article h1, article h2")].map(title => title.textContent.trim());
    new MutationObserver(() => results.textContent && found([results.textContent, titles()])).observe(results, { childList: true });
    setTimeout(() => failed(new Error("nothing found")), 20000);
    input.focus();
    input.value = QUERY;
    for (const type of ["keyup", "input"]) input.dispatchEvent(new Event(type));
})"""


class Site:
    """The site, built once for a class of tests, or by SiteTest for all of those that ctest runs."""

    given = os.environ.get("LAB_TEST_SITE")
    builds = given is None

    @classmethod
    def setUpClass(cls):
        if not shutil.which("mkdocs") or not Path("/usr/share/javascript/katex").exists():
            raise unittest.SkipTest("needs MkDocs and KaTeX, which ./lab book installs")
        cls.site = Path(cls.given or cls.enterClassContext(tempfile.TemporaryDirectory())).resolve() / "book"
        if cls.builds:
            shutil.rmtree(cls.site, ignore_errors=True)  # what an interrupted run left
            subprocess.run([sys.executable, "-B", TOOLS, "book", "--output", cls.site], check=True, stdout=subprocess.DEVNULL)


class SiteTest(Site, unittest.TestCase):
    builds = True

    def test_starts_with_a_page(self):
        self.assertTrue((self.site / "index.html").is_file())


class BookTest(Site, unittest.TestCase):
    def test_lists_and_code_are_those_of_the_pages(self):
        pages = [PROJECT / "README.md", *PROJECT.glob("docs/*.md"), *PROJECT.glob("chapters/*/README.md")]
        for page in pages:
            text, name = page.read_text(encoding="utf-8"), str(page.relative_to(PROJECT))
            site = self.site / re.sub(r"\.md$", ".html", name.replace("README", "index"))
            article = re.search(r"<article.*</article>", site.read_text(encoding="utf-8"), re.DOTALL)[0]
            article = re.sub(r"<summary>The whole path tracer.*?</details>", "", article, flags=re.DOTALL)
            fences = re.compile(r"^ *```.*?^ *```$", re.MULTILINE | re.DOTALL)
            rest = fences.sub("", text)
            self.assertEqual(article.count("<li>"), len(re.findall(r"^ {0,4}(?:\d+\.|[-*]) +\S", rest, re.MULTILINE)), name)
            self.assertEqual(article.count("<pre"), len(fences.findall(text)) + len(re.findall(r"\n\n {4,}\S", rest)), name)

    def test_other_folders_are_not_overwritten(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "thesis.txt"
            file.touch()
            result = subprocess.run([sys.executable, "-B", TOOLS, "book", "--output", folder], capture_output=True, text=True)
            self.assertEqual(result.returncode, 1)
            self.assertRegex(result.stderr, r"\Aerror: [^\n]* is no book: choose another folder\n\Z")
            self.assertTrue(file.exists())

    def test_solutions_are_for_teachers(self):
        if not list(PROJECT.glob("chapters/*/solutions")):
            self.skipTest("there are no solutions")
        self.assertEqual(list(self.site.glob("chapters/*/solutions")), [])


@unittest.skipUnless(CHROMIUM, "needs Chromium: apt-get install chromium")
class BookInBrowser_all(Site, unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.browser = cls.enterClassContext(Browser())
        cls.browser.resize(NARROW)

    def problems(self, page):
        """What is wrong with a page, and the targets of its links: {(file, name)}."""
        self.browser.visit(page.as_uri())
        seen = self.browser.evaluate(INSPECT)
        found = self.browser.complaints() + [f"a formula is text: {formula}" for formula in seen["formulas"]]
        found += [f"from elsewhere: {url}" for url in self.browser.loaded() if not re.match("file:|data:|about:|blob:", url)]
        found += [f"no picture: {url}" for url in seen["pictures"]]
        found += [f"too wide: {element}" for element in seen["wide"]]
        self.names[page] = seen["names"]
        links = {unquote(link).removeprefix("file://").partition("#")[::2] for link in seen["links"] if link.startswith("file:")}
        return found, {(Path(file), name) for file, name in links}

    def dead(self, links):
        return [
            f"{file}#{name}"
            for file, name in links
            if not file.is_file()
            or name
            and name not in (self.names.get(file) or re.findall(r'id="([^"]*)"', file.read_text(encoding="utf-8")))
        ]

    def setUp(self):
        self.names = {}  # page: names that links may target

    def test_every_page(self):
        pages = [page for page in self.site.rglob("*.html") if page.name == "index.html" or page.parent.name == "docs"]
        sources = [page for page in self.site.rglob("*.glsl.html")]
        self.assertGreater(len(pages), 15)
        self.assertGreater(len(sources), 10)
        links = set()
        for page in [*pages, sources[0]]:
            with self.subTest(page=str(page.relative_to(self.site))):
                found, leads = self.problems(page)
                self.assertEqual(found, [])
                links |= leads
        self.assertGreater(len(links), 100)
        self.assertEqual(self.dead(links), [])

    def search(self, query):
        """The text of the results, and their titles."""
        self.browser.visit((self.site / "docs/results.html").as_uri())
        found = self.browser.evaluate(SEARCH.replace("QUERY", json.dumps(query)))
        self.assertEqual(self.browser.complaints(), [])
        return found

    def test_search(self):
        results, _ = self.search("roulette")
        self.assertIn("Russian roulette", results)
        self.assertNotIn("// Chapter 5", results)  # of its shader
        for query, *first in (
            ("alias table", "Chapter 3: next event estimation"),
            ("solid angle", "Chapter 3: next event estimation"),
            ("get_brdf", "What your shader can use", "get_brdf"),
            ("happens(", "What your shader can use", "happens"),
        ):
            results, titles = self.search(query)
            self.assertEqual(titles[: len(first)], first, query)
            self.assertNotRegex(results, r"\\[A-Za-z(\[]", query)

    def test_code_fits(self):
        self.browser.resize(WIDE)
        self.addCleanup(self.browser.resize, NARROW)
        pages = [
            *self.site.glob("chapters/*/index.html"),
            self.site / "docs/first_steps.html",
            self.site / "shaders/world/shading_data.glsl.html",
        ]
        for page in pages:
            self.browser.visit(page.as_uri())
            self.assertEqual(self.browser.evaluate(CUT_CODE), [], page)

    def test_pages_are_for_everybody(self):
        for name in ("index.html", f"chapters/{CHAPTERS[3]}/index.html", "docs/numerics.html"):
            self.browser.visit((self.site / name).as_uri())
            self.assertEqual(self.browser.evaluate(MISSED), [], name)

        def luminance(colour):
            return sum(
                weight * (x / 12.92 if x <= 0.04 else ((x + 0.055) / 1.055) ** 2.4)
                for weight, x in zip((0.2126, 0.7152, 0.0722), colour / 255)
            )

        self.browser.visit((self.site / "shaders/world/shading_data.glsl.html").as_uri())
        for scheme in ("default", "slate"):
            self.browser.evaluate(f"document.body.setAttribute('data-md-color-scheme', '{scheme}')")
            text, behind = (
                np.array([*map(float, re.findall(r"[\d.]+", colour)), 1])[:4] for colour in self.browser.evaluate(COLOURS)
            )
            dark, bright = sorted(map(luminance, (behind[:3] + text[3] * (text - behind)[:3], behind[:3])))
            self.assertGreaterEqual((bright + 0.05) / (dark + 0.05), LEAST_CONTRAST, scheme)

    def test_the_line_of_one_is_in_view(self):
        self.browser.visit((self.site / "docs/results.html").as_uri())
        for name in ("ideas", "mitsuba", "features", "cpu_backends"):
            figure = ElementTree.parse(PROJECT / f"docs/pictures/results_{name}.svg").getroot()
            lines = [
                path.get("d")
                for path in figure.iter("{http://www.w3.org/2000/svg}path")
                if "stroke-width: 1.5" in path.get("style", "")
            ]
            place = float(re.match(r"M ([\d.]+)", lines[0])[1]) / float(figure.get("viewBox").split()[2])
            right = self.browser.evaluate(
                f"(image => image.x + {place} * image.width)(document.querySelector('img[src$=\"results_{name}.svg\"]'))"
            )
            self.assertLess(right, NARROW - 20, name)

    def test_broken_pages_are_found(self):
        text = (self.site / "index.html").read_text(encoding="utf-8")
        page = self.site / "broken.html"
        self.addCleanup(page.unlink)
        for broken, words in (
            ('<a href="nowhere.html">', "nowhere.html"),
            ('<a href="docs/slides.html#nowhere">', "#nowhere"),
            ("$x^2$", "formula"),
            (r'<span class="arithmatex">\(\frac{\)</span>', "formula"),
            ('<img src="nothing.png">', "nothing.png"),
            ('<img src="http://example.org/a.png">', "from elsewhere"),
            ("<script>console.error('broken')</script>", "broken"),
            ("<script>nothing()</script>", "nothing"),
            ('<div style="width: 999px">', "too wide"),
        ):
            page.write_text(text.replace("</article>", f"{broken}</article>"), encoding="utf-8")
            found, links = self.problems(page)
            self.assertIn(words, " ".join(found + self.dead(links)), broken)


class SearchTest(unittest.TestCase):
    def test_formulas_are_plain_text(self):
        for tex, text in (
            (r"\frac{\pi}{2} u_y", "(π)/(2) u_y"),
            (r"\frac{1}{\frac{a}{b}}", "(1)/((a)/(b))"),
            (r"\mathrm{d}\omega \ge \cos\theta", "dω ≥ cosθ"),
            (r"\left( x \cdot y \right)", "( x · y )"),
            (r"\int L \thinspace \mathrm{d}A", "∫ L dA"),
            (r"\{a\}", "a"),
            ("", ""),
        ):
            self.assertEqual(search.plain_formula(tex), text)


class CopiesTest(unittest.TestCase):
    def test_copies_of_chapters_are_left_out(self):
        with tempfile.TemporaryDirectory() as folder:
            project = Path(folder)
            for name in ("chapters", "docs", "tools"):
                shutil.copytree(PROJECT / name, project / name, ignore=shutil.ignore_patterns("records", "__pycache__"))
            shutil.copytree(project / "chapters/01_uniform_sampling", project / "chapters/20_mine")
            listed = [
                sys.executable,
                "-B",
                "-c",
                "import sys; sys.path.insert(0, 'tools'); from book.build import navigation; print(navigation(True))",
            ]
            pages = subprocess.run(listed, cwd=project, capture_output=True, text=True, check=True).stdout
        self.assertIn("chapters/01_uniform_sampling/README.md", pages)
        self.assertNotIn("20_mine", pages)
