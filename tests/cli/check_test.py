"""./lab check: verdicts on shaders that are right, wrong, broken or endless."""

import csv
import json
import os
import re
import shutil
import unittest
from pathlib import Path
from unittest import mock

from program import BINARIES, PROJECT, ProgramTest  # first: it finds the tools
from checking import FEW, SHADER, TECHNIQUE, Checking
import project
from check import command, grading
from check.formats import as_github
from course.mistakes import bugs_of

# The notebook knows the names of mistakes; the tests that ask for one need it.
NAMES = unittest.skipUnless(project.KNOWLEDGE.exists(), "names of mistakes are in the notebook")
ENDLESS = """vec3 path_trace(Ray ray, inout uvec2 seed) {
    float sum = 0.0;
    while (sum >= 0.0) sum = abs(sum) + get_random_numbers(seed).x;
    return vec3(sum);
}
"""
NO_UTF8 = [os.fsdecode(name) for name in (b"m\xfcller.glsl", b"m\xfdller.glsl")]  # as in archives from elsewhere
# A chapter that logs its command lines.
NOTING = """#!/bin/sh
tee -a '{notes}' | '{program}' "$@"
"""


class CheckTest(Checking, ProgramTest):
    def test_the_chapters_own_shader_is_correct(self):
        code, result = self.check_few()
        self.assertEqual((code, result["verdict"]), (0, "correct"), result)
        for scene in result["scenes"]:
            self.assertAlmostEqual(scene["rays"], 1, delta=0.02)
            self.assertLess(max(test["detectable"] for test in scene["image"]), 0.2, "too weak")

    @NAMES
    def test_a_mistake_is_biased_to_its_side(self):
        code, result = self.check_few(self.wrong())
        box = result["scenes"][0]
        self.assertEqual((code, result["verdict"], box["verdict"]), (1, "biased", "biased"))
        self.assertTrue(all(test["is_biased"] and test["value"] > 0 for test in box["image"]), box["image"])
        found = result["diagnosis"]
        self.assertIn("twice as far away", found["mistakes"][0]["hint"])
        self.assertNotIn("name", found["mistakes"][0], "only for teachers")
        self.assertIn("off by the distance: light of a lamp after one bounce", [fact["text"] for fact in found["facts"]])
        self.assertIn("a lamp that the camera sees", found["right"])
        self.assertTrue((PROJECT / result["picture"]).read_bytes().startswith(b"\x89PNG"))

    @NAMES
    def test_a_teacher_gets_the_name_and_a_student_a_question(self):
        for options, is_named in (((), False), (("--teacher",), True)):
            code, out, err = self.check(*FEW, *options, self.wrong())
            self.assertEqual(code, 1, err)
            self.assertRegex(err, r"(?m)^so far +[^\n]*is too ")
            self.assertRegex(out, r"\Abiased [^\n]*twice as far away\?\n")
            self.assertRegex(out, r"read again .*Next Event Estimation")
            self.assertEqual("distance-not-squared" in out, is_named, out)

    def test_tells_early_what_is_sure(self):
        """For a shader with a mistake, it tells it where a teacher gets the mistake's name."""
        self.assertRegex(self.check(*FEW)[2], r"(?m)^so far +[^\n]*no picture is wrong by")

    def test_a_bias_that_experiments_confirm_takes_no_more_renders(self):
        found = {"facts": [], "mistakes": [], "fits": False, "next": None, "right": [], "too_noisy": None, "wrong": ["angle"]}
        for is_confirmed, form, runs in ((True, "--json", grading.EARLY_RUNS), (False, "--json", 6), (True, "--gradescope", 6)):
            results = []
            with (
                mock.patch.object(command, "judge", lambda *a, **b: results.append(grading.judge(*a, **b)) or results[-1]),
                mock.patch.object(command, "diagnose", return_value=found | {"is_beyond_doubt": is_confirmed}),
                self.in_one_scene(),
            ):
                self.check(3, "--runs", 6, "--samples", 4, form, self.wrong())
            (result, (picture,)), first = results[-1], results[0][1][0]
            self.assertEqual((result["verdict"], result["runs"], len(results)), ("biased", runs, 1 if is_confirmed else 2))
            self.assertAlmostEqual(first.mean() / picture.mean(), 1, delta=0.05)

    def test_the_answer_is_short_and_has_details_on_demand(self):
        (_, short, _), (_, long, _) = self.check(*FEW, self.wrong()), self.check(*FEW, "--details", self.wrong())
        facts = re.findall(r"(?m)^seen +(.*)", short)
        self.assertTrue(1 <= len(facts) <= 5 and not any("…" in fact for fact in facts), facts)
        self.assertNotIn("check_room_2  ", short)
        for words in (
            "check_room_2 +biased: mean ",
            "seen +light of a lamp after one bounce: wrong by a factor that follows the distance;",
            "right +a lamp that the camera sees$",
        ):
            self.assertRegex(long, rf"(?m)^{words}")
        self.assertTrue(long.startswith(short[: short.index("more  ")]))

    def test_the_chapters_own_noise_is_compared_render_by_render(self):
        result = json.loads(self.check(3, "--runs", 2, "--json")[1])
        for scene in result["scenes"]:
            self.assertAlmostEqual(scene["noise"][1], 1, delta=0.05, msg="the same random numbers")
            self.assertAlmostEqual(scene["noise"][2], 1, delta=0.05)

    @NAMES
    def test_for_gradescope_and_github(self):
        file = self.wrong()
        code, out, _ = self.check(*FEW, "--gradescope", "--points", 12, file)
        result = json.loads(out)
        self.assertEqual((code, [test["max_score"] for test in result["tests"]]), (1, [6, 6, 0]))  # the last scene has no lamps
        self.assertEqual([test["score"] for test in result["tests"]], [0, 0, 0])
        self.assertTrue({test["status"] for test in result["tests"]} <= {"passed", "failed"})
        self.assertIn("twice as far away", result["output"])
        code, out, _ = self.check(*FEW, "--github", file)
        self.assertRegex(out, rf"(?m)^::error file={file},line=1,title=\S+ \S+::biased: [^\n]*twice as far away\?%0Aseen: ")
        broken = self.write("broken.glsl", "// one\nvec3 path_trace(Ray ray, inout uvec2 seed) { return nothing; }\n")
        self.assertIn("file=%25%3A%2C.glsl,line=1,", as_github("biased", "%:,.glsl", None, []))
        self.assertRegex(self.check(*FEW, "--github", broken)[1], rf"(?m)^::error file={broken},line=2,")
        result = json.loads(self.check(*FEW, "--gradescope", broken)[1])
        self.assertEqual([(test["score"], test["max_score"]) for test in result["tests"]], [(0, 10)])

    def test_a_folder_without_mistakes_has_no_list_of_them(self):
        self.write("all/anna.glsl", SHADER.read_bytes())
        code, out, err = self.check(*FEW, "--all", self.folder / "all", "--output", self.folder / "graded")
        self.assertEqual((code, out), (0, "1 of 1: anna: correct\n"), err)

    def test_a_shader_may_have_a_path_of_its_own(self):
        text = SHADER.read_text(encoding="utf-8")
        own = "struct Path { Ray ray; };\nPath start_path(Ray ray) { return Path(ray); }\nvec3 path_trace("
        with self.in_one_scene():
            self.assertEqual(self.check_few(self.write("mine.glsl", text.replace("vec3 path_trace(", own)))[0], 0)

    def test_a_tile_that_rare_paths_reach_is_not_dark_where_all_runs_miss_them(self):
        """The focus scene has a tile of sky that the rim of a blurred lamp grazes: half of all checks of the right shader miss it."""
        reference = grading.reference_regions(PROJECT / "assets/references/focus_5.exr")
        floor = grading.TILE_FLOOR * sum(reference["mean"][:3]) / 3
        for difference, is_biased in ((3, False), (20, True)):
            means = list(reference["mean"])
            means[3 + 13] -= difference * floor  # the second tile of the second row
            runs = [{"seed": seed, "rows": [{"samples": 16, "mean": means}]} for seed in range(1, 13)]
            self.assertEqual([test["is_biased"] for test in grading.biases(runs, reference, 3000)].count(True), is_biased)

    def test_memory_is_limited(self):
        code, _, err = self.run_tool("check", 3, "--memory-limit", 0.1, "--runs", 2, "--samples", 1)
        self.assertEqual(code, 2)
        # Shaders that the driver has compiled before need less, so that one picture or another may be done.
        self.assertRegex(err, r"\A(\d+ %, [^\n]*\n)*error: [^\n]{12,}\n\Z")

    def test_checks_with_other_seeds_share_no_render(self):
        """Also with more runs, and in experiments: otherwise a false alarm would recur with another --seed."""
        program = self.write(
            f"binaries/{SHADER.parent.name}", NOTING.format(notes=self.folder / "notes", program=BINARIES / SHADER.parent.name)
        )
        program.chmod(0o755)
        seeds = []
        for seed in (0, 1):
            with mock.patch.object(project, "BINARIES", program.parent), mock.patch.object(
                Checking, "judged", {}
            ), self.in_one_scene():
                self.check(3, "--runs", 2 + seed, "--samples", 1, "--seed", seed, "--time-limit", 100)
            notes = (self.folder / "notes").read_text()
            (self.folder / "notes").unlink()
            rendered = re.findall(r'/(check_room|point)\w*\.json".*"--seed" "(\d+)"', notes)
            self.assertEqual(sum(what == "check_room" for what, _ in rendered), 2 + seed)
            self.assertIn("point", dict(rendered), "experiments that decide")
            seeds.append({number for _, number in rendered})
        self.assertFalse(seeds[0] & seeds[1], seeds)

    def test_samples_that_depend_on_each_other_have_the_number_of_their_level(self):
        self.assert_tool_refused(["check", 9, "--samples", 4], "--samples", "leave it out", code=2)

    def test_what_is_no_file_is_refused(self):
        self.assert_tool_refused(["check", 3, "missing.glsl"], "missing.glsl: no such file", code=2)
        self.assert_tool_refused(["check", 3, PROJECT / "chapters"], "chapters: a folder", "--all", code=2)

    def test_a_backend_that_programs_lack_is_refused_with_those_that_they_have(self):
        self.assert_tool_refused(["check", 3, "--backend", "raster"], "--backend: raster not in", "compute", code=2)

    def test_what_is_still_to_be_written_is_no_mistake(self):
        text = TECHNIQUE.read_text(encoding="utf-8")
        geometry = "float geometry = "
        line = text[: text.index(geometry)].count("\n") + 1
        file = self.write("mine.glsl", text.replace(geometry, "float geometry = 0.0; // TODO: "))
        with self.in_one_scene(), mock.patch.object(command, "judge", grading.judge):
            code, result = self.check_few(file)
        self.assertEqual(
            (code, result["unfinished_file"], result["unfinished_line"], result["diagnosis"]), (1, str(file), line, None)
        )
        self.assertEqual(result["runs"], grading.EARLY_RUNS)

    def test_more_noise_and_rays_than_needed_are_reported(self):
        # One path too many, and each sample counts twice or not at all: the mean stays, the noise more than doubles.
        text = SHADER.read_text(encoding="utf-8").replace("vec3 path_trace(", "vec3 trace_path(") + (
            "vec3 path_trace(Ray ray, inout uvec2 seed) {\n"
            "    trace_path(ray, seed);\n"
            "    return get_random_numbers(seed).x < 0.5 ? 2.0 * trace_path(ray, seed) : vec3(0.0);\n}\n"
        )
        with self.in_one_scene(), mock.patch.object(
            command,
            "diagnose",
            return_value={
                "facts": [],
                "right": [],
                "mistakes": [],
                "fits": False,
                "next": None,
                "is_beyond_doubt": False,
                "wrong": [],
            },
        ):
            code, result = self.check_few(self.write("mine.glsl", text))
        box = result["scenes"][0]
        self.assertEqual((code, box["verdict"]), (1, "noisy"), box["noise"])
        self.assertGreater(box["noise"][2], 2)  # 2 + (mean / deviation)² in each pixel
        self.assertAlmostEqual(box["rays"], 1.5, delta=0.02)

    def test_a_strategy_that_is_ignored_is_found_although_the_pictures_are_right(self):
        file = self.planted(7, "STRATEGY == STRATEGY_LIGHT ? 0.0 : get_bsdf_density", "get_bsdf_density")
        with mock.patch.dict(grading.SCENES, {7: (12, ["plates_3"])}):
            code, out, err = self.check(7, "--runs", 4, "--json", file)
        result = json.loads(out)
        self.assertEqual((code, result["verdict"], result["scenes"][0]["verdict"]), (1, "biased", "correct"), err)
        self.assertRegex(json.dumps(result["diagnosis"]["facts"]), "--strategy light")

    def test_a_broken_shader_is_reported_by_file_and_line(self):
        lines = SHADER.read_text(encoding="utf-8").splitlines()
        line = next(i for i, line in enumerate(lines) if "throughput = " in line)
        lines[line] = lines[line].replace(";", "")
        file = self.write("mine.glsl", "\n".join(lines) + "\n")
        code, _, err = self.run_tool("check", 3, file)
        self.assertEqual(code, 2)
        self.assertRegex(err, rf"\Aerror: [^\n]*{re.escape(str(file))}:{line + 2}: [^\n]+\n\Z")

    def test_the_compilers_message_arrives_whatever_its_bytes(self):
        code, _, err = self.check(*FEW, self.write("mine.glsl", b'#line 7 "\xfc.glsl"\nnothing;\n' + SHADER.read_bytes()))
        self.assertEqual(code, 2)
        self.assertRegex(err, r"\Aerror: [^\n]*\.glsl:7: [^\n]*syntax error[^\n]*\n\Z")

    def test_a_name_that_is_no_utf8_can_be_printed(self):
        for contents, code in ((SHADER.read_bytes(), 0), (b"nothing", 2)):
            file = self.write(NO_UTF8[0], contents)
            for form in ((), ("--github",)):
                actual, out, err = self.check(*FEW, *form, file)
                self.assertEqual(actual, code, err)
                self.assertIn(r"m\xfcller.glsl", (out + err).encode().decode())

    def test_where_no_picture_can_be_written_the_verdict_stays(self):
        """In a read-only checkout."""
        (self.folder / "read_only").mkdir()
        self.write("read_only/output", "no folder")
        with mock.patch.object(command, "ROOT", self.folder / "read_only"):
            code, result = self.check_few(self.wrong())
        self.assertEqual((code, result["verdict"]), (1, "biased"))
        picture = Path(result["picture"])
        self.addCleanup(shutil.rmtree, picture.parent)
        self.assertTrue(picture.read_bytes().startswith(b"\x89PNG"))

    def test_an_endless_loop_is_ended(self):
        """Also one outside the shader: the loop over the bounces of a path that never ends."""
        path = self.planted(
            7,
            "get_background_radiance(path.ray.direction);\n        return false;",
            "get_background_radiance(path.ray.direction);\n        return true;",
        )
        for chapter, file in ((3, self.write("endless.glsl", ENDLESS)), (7, path)):
            code, _, err = self.run_tool("check", chapter, file, "--time-limit", 1)
            self.assertEqual(code, 2)
            self.assertRegex(err, r"\Aerror: [^\n]*(ended after 1 s: does each loop [^\n]*, and each path\?|device)[^\n]*\n\Z")

    def test_what_cannot_be_graded(self):
        for arguments in ((99,), (3, "nothing.glsl"), ("three",), (3, "--all", "nowhere"), (3, "--all", ".", SHADER)):
            code, out, err = self.check(*arguments)
            self.assertEqual((code, out), (2, ""))
            self.assertRegex(err, r"\Aerror: [^\n]{12,}\n\Z")


class Check_all(Checking, ProgramTest):
    def graded(self):
        return list(csv.DictReader((self.folder / "graded/results.csv").read_text(encoding="utf-8-sig").splitlines()))

    @NAMES
    def test_a_folder_is_graded_into_a_table_and_goes_on(self):
        text = SHADER.read_text(encoding="utf-8")
        (self.folder / "all/dora").mkdir(parents=True)
        self.write("all/anna.glsl", text)
        self.write("all/bob.glsl", "nothing")
        for name in NO_UTF8:
            self.write(Path("all") / name, text)
        self.write("all/=1 #2, ü.glsl", "vec3 path_trace(Ray ray, inout uvec2 seed) { return vec3(0.3); }")  # traces no rays
        self.write("all/carl.glsl", "vec3 path_trace(Ray ray, inout uvec2 seed) {\n    // TODO\n    return vec3(0.2);\n}\n")
        (self.folder / "all/gone.glsl").symlink_to("nowhere")
        self.write("all/dora/path_trace.glsl", self.wrong().read_bytes())
        grade_all = (*FEW, "--all", self.folder / "all", "--output", self.folder / "graded")
        expected = {
            "'=1 #2, ü": "biased",
            "anna": "correct",
            "bob": "not graded",
            "carl": "unfinished",
            "dora": "biased",
            "gone": "not graded",
        }
        expected |= {r"m\xfcller": "correct", r"m\xfdller": "correct"}
        code, out, err = self.check(*grade_all)
        self.assertEqual(code, 2, err)
        self.assertRegex(
            out,
            rf"what is wrong most often\n(\d of \d: [^\n]*\n)*1 of 8: [^\n]*twice as far away\? \([^\n]*chapters/{SHADER.parent.name}/README.md\): off by the distance",
        )
        table = self.graded()
        self.assertEqual({row["submission"]: row["verdict"] for row in table}, expected)
        page = (self.folder / "graded/index.html").read_text(encoding="utf-8")
        self.assertEqual(
            sorted(re.findall(r'<img src="(.*?)"', page)),
            ["%3D1%20%232%2C%20%C3%BC.png", "anna.png", "carl.png", "dora.png", "m%5Cxfcller.png", "m%5Cxfdller.png"],
        )
        self.assertTrue((self.folder / "graded/anna.png").read_bytes().startswith(b"\x89PNG"))

        self.write("all/abe.glsl", ENDLESS)
        self.judge.reset_mock()
        self.assertEqual(self.check(*grade_all, "--time-limit", 1)[0], 2)
        self.assertEqual(
            [call.args[0].file.stem for call in self.judge.mock_calls], ["abe", "bob"], "the others are not graded anew"
        )
        rows = {row["submission"]: row for row in self.graded()}
        self.assertEqual({name: row["verdict"] for name, row in rows.items()}, expected | {"abe": "not graded"})
        self.assertRegex(rows["abe"]["error"], "ended after 1 s|device")
        self.assertEqual(
            [rows[row["submission"]] for row in table if row["verdict"] != "not graded"],
            [row for row in table if row["verdict"] != "not graded"],
        )

    @NAMES
    def test_the_process_ends_with_the_verdict(self):
        for arguments, expected, early, words in (
            ((), 0, "no picture is wrong", "correct +nothing differs, "),
            ((self.wrong(), "--teacher"), 1, "is too bright", "biased +distance-not-squared: "),
        ):
            code, out, err = self.run_tool("check", 3, "--runs", 5, "--samples", 1, "--backend", "compute", *arguments)
            self.assertEqual(code, expected, err)
            self.assertRegex(err, rf"(?m)^so far +[^\n]*{early}")
            self.assertRegex(out, rf"\A{words}")


class LaterChapters_all(Checking, ProgramTest):
    def test_mistakes_at_a_turned_light_probe_above_lamps_are_found(self):
        for find, replace in (
            (" - 0.5) - parameters.probe_rotation;", " - 0.5) + parameters.probe_rotation;"),
            ("happens(LIGHT_PROBE_PROBABILITY, seed)", "happens(0.8, seed)"),
        ):
            with mock.patch.dict(grading.SCENES, {8: (12, ["check_sky_4"])}):
                code, out, err = self.check(8, "--runs", 5, "--json", self.planted(8, find, replace))
            self.assertEqual(code, 1, f"{replace}: {out}{err}")

    def test_a_path_that_keeps_something_of_the_last_one_is_found(self):
        kept = [bug for bug in bugs_of(10) if bug.mistake["name"].endswith("-of-the-last-path")]
        self.assertEqual(len(kept), 3)
        for bug in kept:
            with mock.patch.dict(grading.SCENES, {10: (16, ["textured_4"])}):
                code, out, err = self.check(10, "--runs", 4, "--json", self.write(f"{bug.mistake['name']}.glsl", bug.text))
            self.assertEqual((code, json.loads(out)["verdict"]), (1, "biased"), f"{bug.mistake['name']}: {out}{err}")

    def test_points_that_lose_what_the_chapter_gains_are_noisy(self):
        file = self.planted(9, "scramble_reversed(get_second_dimension(index), keys.y)", "scramble_reversed(index, keys.y)")
        with mock.patch.dict(grading.SCENES, {9: (16, ["cornell_box_1"])}):
            code, out, err = self.check(9, "--json", file)
        scene = json.loads(out)["scenes"][0]
        self.assertEqual((code, scene["verdict"]), (1, "noisy"), scene["noise"])
        self.assertLess(scene["most_noise"], grading.TOO_MUCH)
