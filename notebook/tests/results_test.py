"""What pages get from records: tables that compare with peers, and plots, with known true values."""

import re
import sys
import tempfile
import unittest
from contextlib import ExitStack
from pathlib import Path
from unittest import mock

import paths  # noqa: F401  (first: it finds the others)
import includes
import project
from docs import page_plots
from docs.tables import DOCS, PAGES
from report import sources as digests
from tables import (
    ages,
    best_table,
    confusion_table,
    cpu_table,
    export,
    peer_table,
    records,
    renderer_table,
    result_plots,
    sources,
)

SPEEDS = {"chapter 3": 4.0, "chapter 5": 2.0, "Mitsuba scalar": 0.1, "Mitsuba CUDA": 1.0}


def scene_of_peers(name, width, speeds):
    """A scene of a report, with exact gains. If a case has no speed, its error was lost in noise."""
    gains = [
        {"case": case, "peer": peer, "gain": [speeds[case] / speeds[peer] if speeds[case] else None, None, None]}
        for case in speeds
        for peer in speeds
        if peer != case and peer.startswith("Mitsuba")
    ]
    cases = [
        {
            "case": case,
            "is_peer": case.startswith("Mitsuba"),
            "backend": "compute",
            "samples_per_second": 2e9,
            "paths_per_second": 8e9,
            "error_of_one_sample": 0.5,
            "seconds_to_target": [1.0, None, None],
            "start_up_seconds": [0.5, None, None],
        }
        for case in speeds
    ]
    return {"scene": name, "width": width, "height": width, "gains": gains, "cases": cases}


def record_of_peers(*scenes):
    return {"environment": {"device": "a device", "peer": "Mitsuba"}, "scenes": list(scenes)}


def rows_of(text):
    return [[cell.strip() for cell in line.split("|")[1:-1]] for line in text.splitlines() if line.startswith("| ")]


class PeerTableTest(unittest.TestCase):
    def test_without_other_samplers(self):
        text = peer_table.peer_table(record_of_peers(scene_of_peers("box_6", 128, SPEEDS)))
        self.assertIn("Mitsuba's sampler is `independent`", text)
        head, _, first, *_ = rows_of(text)
        self.assertEqual(head[5:7], ["times faster than Mitsuba scalar", "times faster than Mitsuba CUDA"])
        self.assertEqual(first[:7], ["`box`", "chapter 3", "2,000", "8,000", "0.50", "40", "4.0"])

    def test_the_best_sampler_is_named_and_compared_with(self):
        samplers = {"Mitsuba CUDA, ldsampler": 0.5, "Mitsuba CUDA, multijitter": 1.25}
        scenes = [scene_of_peers(name, 128, SPEEDS | samplers) for name in ("box_6", "heart_4")]
        text = peer_table.peer_table(record_of_peers(*scenes))
        self.assertIn("best sampler here is `multijitter`.", text)
        self.assertIn("0.50 (ldsampler), 1.25 (multijitter)", text)
        head, _, first, *others = rows_of(text)
        self.assertIn("times faster than Mitsuba CUDA, multijitter", head)
        self.assertNotIn("times faster than Mitsuba CUDA, ldsampler", head)
        self.assertEqual(first[7], "3.2")
        self.assertEqual(others[4][1:8], ["Mitsuba CUDA, multijitter", "2,000", "8,000", "0.50", "12", "1.2", ""])

    def test_independent_may_be_the_best(self):
        scene = scene_of_peers("box_6", 128, SPEEDS | {"Mitsuba CUDA, ldsampler": 0.5})
        self.assertIn("best sampler here is `independent`.", peer_table.peer_table(record_of_peers(scene)))

    def test_each_size_has_a_table(self):
        sizes = [scene_of_peers(name, width, SPEEDS) for name, width in (("box_6", 128), ("box_6_1024", 1024))]
        text = peer_table.peer_table(record_of_peers(*sizes))
        self.assertRegex(text, r"(?s)128 x 128 pixels:.*1024 x 1024 pixels:")
        self.assertEqual([row[0] for row in rows_of(text) if row[1] == "chapter 3"], ["`box`", "`box`"])


class BestTableTest(unittest.TestCase):
    def test_best_against_peers(self):
        speeds = SPEEDS | {"chapter 5": 5.0, "chapter 6": None, "Mitsuba CUDA, multijitter": 1.25}
        record = record_of_peers(
            scene_of_peers("box_6_1024", 1024, speeds), scene_of_peers("empty_2", 128, {"Mitsuba CUDA": 1.0})
        )
        self.assertEqual(
            list(best_table.against_peers(record)), [(("box", 1024, 1024), ["chapter 5", "Mitsuba CUDA, multijitter", "4.0"])]
        )

    def chapter(self, name, error, scene="box_6"):
        runs = [{"seed": seed, "rows": [{"rel_mse": error, "device_seconds": 2.0}]} for seed in (1, 2)]
        return {"case": name, "scene": scene, "width": 128, "height": 128, "reference": None, "runs": runs}

    def test_best_among_chapters(self):
        cases = [
            self.chapter("chapter 1", 8.0),
            self.chapter("chapter 3", 0.5),
            self.chapter("chapter 4", 1.0),
            self.chapter("strategy both", 0.1),
            self.chapter("chapter 5", 1.0, "heart_4"),
        ]
        self.assertEqual(
            list(best_table.among_chapters({"cases": cases})),
            [(("box", 128, 128), ["chapter 3", "16 (16 – 16)"]), (("heart", 128, 128), ["chapter 5", "1"])],
        )


class CpuTableTest(unittest.TestCase):
    def test_times_faster_by_both_clocks(self):
        def case(name, seconds, cpu_seconds, error=0.5):
            row = {"rel_mse": error, "seconds": seconds, "cpu_seconds": cpu_seconds}
            return {
                "case": name,
                "scene": "box_6",
                "width": 100,
                "height": 100,
                "samples": 10,
                "reference": None,
                "runs": [{"seed": seed, "rows": [row]} for seed in (1, 2)],
            }

        record = {
            "environment": {"processor": "a CPU", "cores": 4, "device": "a driver", "peer": "Mitsuba"},
            "cases": [case("native", 2.0, 4.0, 0.25), case("Mitsuba LLVM", 1.0, 4.0)],
        }
        self.assertEqual(cpu_table.cpu_gains(record, "seconds"), {"box": {"native": [1.0, 1.0, 1.0]}})
        text = cpu_table.cpu_table(record)
        self.assertIn("a CPU, 4 cores, a driver, and Mitsuba.", text)
        _, _, native, mitsuba = rows_of(text)
        self.assertEqual(native, ["`box`", "native", "0.0500", "40", "2.5", "1.0 (1.0 – 1.0)", "2.0 (2.0 – 2.0)"])
        self.assertEqual(mitsuba, ["", "Mitsuba LLVM", "0.100", "40", "5.0", "1", "1"])


class RendererTableTest(unittest.TestCase):
    def case(self, name, errors, cpu_seconds, is_peer=True):
        """Two runs with the same errors, whose means differ by 2 % around the reference's."""
        rows = [
            [
                {
                    "samples": samples,
                    "rel_mse": error,
                    "seconds": 1 + cpu_seconds,
                    "cpu_seconds": cpu_seconds,
                    "mean": [mean] * 3,
                    "difference": [0.01] * 3,
                }
                for samples, error in zip(renderer_table.COUNTS, errors)
            ]
            for mean in (0.99, 1.01)
        ]
        reference = {"mean": [1.0] * 3, "variance": [0.0] * 3, "freedom": 10, "rel_mse_deviation": 0.0}
        return {
            "case": name,
            "is_peer": is_peer,
            "scene": "box_6",
            "width": 100,
            "height": 100,
            "refused": None,
            "program": "another" if is_peer else "10_path_regeneration",
            "reference": reference,
            "runs": [{"seed": seed + 1, "rows": part} for seed, part in enumerate(rows)],
        }

    def record(self):
        cases = [
            self.case("chapter 10, native", [0.04, 0.01, 0.0025, 0.0005], 1.0, False),
            self.case("LuxCore, Sobol", [0.08, 0.03, 0.005, 0.002], 2.0),
        ]
        renderers = {"chapter 10, native": "a driver", "LuxCore, Sobol": "LuxCore 2"}
        return {"environment": {"processor": "a CPU", "cores": 2, "renderers": renderers}, "cases": cases}

    def test_gains_are_of_pictures_with_as_many_samples(self):
        gains = renderer_table.renderer_gains(self.record(), "cpu_seconds")["box"]["LuxCore, Sobol"]
        self.assertEqual({samples: round(ratio[0], 6) for samples, ratio in gains.items()}, {16: 4, 64: 6, 256: 4, 1024: 8})

    def test_table(self):
        text = renderer_table.renderer_table(self.record())
        self.assertIn("a CPU, 2 cores, and LuxCore 2.", text)
        _, _, ours, peer, _, _, _, by_cpu, _, _, _, by_wall = rows_of(text)
        self.assertEqual(ours[:5], ["`box`", "chapter 10, native", "0.64", "1.6", "0.64"])
        self.assertEqual(peer[:5], ["", "LuxCore, Sobol", "1.9", "3.1", "1.3"])
        self.assertRegex(peer[5], r"^[+]0.000 ± 12\.7\d\d %$")
        self.assertEqual(by_cpu[3], "6.0 (6.0 – 6.0)")
        self.assertEqual(by_wall[3], "4.5 (4.5 – 4.5)")

    def test_a_scene_may_have_fewer_numbers_of_samples(self):
        record = self.record()
        for run in (run for case in record["cases"] for run in case["runs"]):
            del run["rows"][-1]
        self.assertEqual([*renderer_table.renderer_gains(record, "seconds")["box"]["LuxCore, Sobol"]], [16, 64, 256])
        self.assertEqual(rows_of(renderer_table.renderer_table(record))[7][-2:], ["4.0 (4.0 – 4.0)", ""])

    def test_what_is_left_out_is_said(self):
        record, refused = self.record(), {"scene": "glass_8", "refused": "LuxCore is not compared on glass", "runs": []}
        record["cases"] += [refused, refused]
        text = renderer_table.renderer_table(record)
        self.assertEqual(text.count("\nNot in `glass`: LuxCore is not compared on glass.\n"), 1)
        self.assertNotIn("`box`: ", text)

    def test_what_is_biased_is_said(self):
        record = self.record()
        for run in record["cases"][1]["runs"]:
            run["rows"][-1]["mean"] = [1.5 + 0.001 * run["seed"], 1.0, 1.0]
        self.assertRegex(renderer_table.renderer_table(record), r"[+]50.* % \(biased\)")


class NoRayTracingCoresTest(unittest.TestCase):
    def test_is_said_wherever_times_on_such_a_device_are_compared(self):
        for page in [*PAGES, *export.RESULTS.glob("*.md")]:
            text = page.read_text(encoding="utf-8")
            plots = [page.parent / name for name in re.findall(r"\]\(((?!http)[^)]*/results_\w+\.svg)\)", text)]
            drawn = "".join(plot.read_text(encoding="utf-8") for plot in plots)
            if "NVIDIA H200" in text + drawn and page.name != "numerics.md":  # which lists errors, not times
                self.assertTrue(export.NO_RAY_TRACING_CORES in text, page)

    def test_plots_say_it(self):
        for plot in (DOCS / "pictures").glob("*.svg"):
            text = plot.read_text(encoding="utf-8")
            self.assertEqual("H200" in text, "without ray tracing cores" in text, plot)
        self.assertEqual(result_plots.short_device("NVIDIA H200"), "NVIDIA H200 (without ray tracing cores)")
        self.assertEqual(result_plots.short_device("NVIDIA GeForce RTX 4090"), "NVIDIA GeForce RTX 4090")
        self.assertEqual(result_plots.short_device("llvmpipe (LLVM 15.0.6, 256 bits)"), "llvmpipe")


class ResultPlotsTest(unittest.TestCase):
    def test_colours_are_seen_on_white_and_on_black(self):
        for file in (DOCS / "pictures").glob("*.svg"):
            text = file.read_text(encoding="utf-8")
            colours = set(re.findall(r"#[0-9a-f]{6}", text))
            self.assertTrue(colours <= {*page_plots.COLOURS, page_plots.GREY}, f"{file}: {colours}")
            self.assertEqual(
                len(re.findall("<text", text)),
                len(re.findall('<text style="[^"]*fill: #', text)),
                f"{file}: text without a colour is black",
            )

    def test_no_plot_has_a_colour_twice(self):
        for name, draw in result_plots.PLOTS.items():
            figure, _ = draw()
            shown = [handles for axis in figure.axes if (handles := axis.get_legend_handles_labels()[0])]
            self.assertGreater(len(shown), 0, name)
            for handles in shown:
                colours = [getattr(handle, "lines", [handle])[0].get_color() for handle in handles]
                self.assertEqual(len(set(colours)), len(colours), name)
                self.assertNotIn(page_plots.GREY, colours, name)
            result_plots.pyplot.close(figure)

    def test_plots_name_chapters_and_sizes_and_leave_outliers_out(self):
        text = {name: (DOCS / f"pictures/results_{name}.svg").read_text(encoding="utf-8") for name in ("ideas", "mitsuba")}
        self.assertIn("3 Next event estimation", text["ideas"])
        self.assertIn("microfacets, 144 × 112", text["mitsuba"])
        self.assertNotIn("²", text["mitsuba"])
        for name, lowest, highest in (("ideas", 1e-2, 1e1), ("mitsuba", 1e-1, 1e3)):
            figure, _ = result_plots.PLOTS[f"results_{name}"]()
            for axis in figure.axes:
                self.assertTrue(lowest <= axis.get_xlim()[0] and axis.get_xlim()[1] <= highest, f"{name}: {axis.get_xlim()}")
            self.assertRegex(text[name], "◂ 0.00025" if name == "ideas" else "▸")
            result_plots.pyplot.close(figure)

    def test_other_numbers_make_a_plot_stale(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "plot.svg"
            result_plots.write_plot(file, "results_check")
            self.assertTrue(result_plots.is_fresh(file, "results_check"))
            with mock.patch.object(
                result_plots, "rates", lambda record: confusion_table.rates({"trials": dict(list(record["trials"].items())[:50])})
            ):
                self.assertFalse(result_plots.is_fresh(file, "results_check"))


class ExportTest(unittest.TestCase):
    def test_pages_and_plots_show_the_records(self):
        with mock.patch.object(sys, "argv", ["export", "--check"]):
            export.main()

    def test_pages_say_what_was_measured(self):
        self.assertRegex(export.measured_table("headline", PAGES[0]), r"measured on \d{4}-\d\d-\d\d, commit [0-9a-f]{7}")


class AgesTest(unittest.TestCase):
    RECORD = '{"program": "05_russian_roulette"}'

    def test_comments_and_other_chapters_do_not_count(self):
        with tempfile.TemporaryDirectory() as folder, ExitStack() as patches:
            for module in (digests, includes, project):
                patches.enter_context(mock.patch.object(module, "ROOT", Path(folder)))
            files = {
                name: Path(folder) / name
                for name in (
                    "shaders/a.glsl",
                    "chapters/05_russian_roulette/path_trace.glsl",
                    "chapters/05_russian_roulette/chapter.json",
                    "chapters/04_splitting/path_trace.glsl",
                )
            }
            for file in files.values():
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_text('{"options": ["a"], "measure": {}}' if file.suffix == ".json" else "a = 1;  // one\n")
            (Path(folder) / "shaders/replaceable.json").write_text("[]")
            before = sources.measured(self.RECORD)
            self.assertEqual(list(before), ["renderer", "russian_roulette"])
            record = {"measured": before}
            self.assertEqual(sources.changed_since(record), [])
            for name, text, changed in (
                ("shaders/a.glsl", "a =  1; // two\n", []),
                ("shaders/a.glsl", "a = 2;", ["renderer"]),
                ("chapters/04_splitting/path_trace.glsl", "b", []),
                ("chapters/05_russian_roulette/chapter.json", '{"options": ["a"], "measure": {"picture": "b"}}', []),
                ("chapters/05_russian_roulette/chapter.json", '{"options": ["b"]}', ["russian_roulette"]),
                ("chapters/05_russian_roulette/path_trace.glsl", "b", ["russian_roulette"]),
            ):
                kept = files[name].read_text()
                files[name].write_text(text)
                self.assertEqual(sources.changed_since(record), changed, (name, text))
                files[name].write_text(kept)

    def test_the_age_of_records_without_a_digest_is_unknown(self):
        self.assertEqual(ages.state({}), "unknown: recorded before versions were stored")

    def test_a_stamped_record_is_up_to_date(self):
        record = sources.stamped({"tests": {"chapter_05_russian_roulette": "passes"}})
        self.assertEqual(ages.state(record), "up to date")
        self.assertRegex(records.when(record), r"20..-..-.., commit ")
        record["measured"]["renderer"] = record["measured"]["russian_roulette"] = "0"
        self.assertEqual(ages.state(record), "older: renderer, russian_roulette changed since")
