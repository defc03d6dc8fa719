"""The package: doctests, types, interchange, the program beside the module."""

import contextlib
import doctest
import io
import os
import re
import subprocess
import sys
import tempfile
import unittest

import numpy as np
import support
import touchline
from touchline import interchange

try:
    import mypy  # noqa: F401
except ImportError:
    NO_MYPY = "mypy is not installed"
else:
    NO_MYPY = ""
try:
    import pandas  # noqa: F401
except ImportError:
    NO_PANDAS = "pandas is not installed"
else:
    NO_PANDAS = ""


class Documented(unittest.TestCase):
    def test_doctests(self):
        here = os.getcwd()
        os.chdir(support.ROOT)
        try:
            for module in (touchline, interchange):
                found = doctest.testmod(module)
                self.assertGreater(found.attempted, 5)
                self.assertEqual(found.failed, 0)
        finally:
            os.chdir(here)

    def test_the_guides_example(self):
        with open(os.path.join(support.ROOT, "assets/guide/library.md"), encoding="utf-8") as file:
            blocks = re.findall(r"```python\n(.*?)```", file.read(), re.S)
        (block,) = [block for block in blocks if "touchline.load(" in block]
        here, said = os.getcwd(), io.StringIO()
        with tempfile.TemporaryDirectory() as folder:
            os.symlink(os.path.join(support.ROOT, "projects"), os.path.join(folder, "projects"))
            os.chdir(folder)
            try:
                with contextlib.redirect_stdout(said):
                    exec(compile(block, "library.md", "exec"), {})
                self.assertTrue(os.path.exists("solved.json"))
            finally:
                os.chdir(here)
        self.assertRegex(said.getvalue(), r"0\.9\d+ <touchline\.Camera pan ")

    def test_everything_has_a_docstring(self):
        for name in touchline.__all__:
            if name == "__version__":
                continue
            item = getattr(touchline, name)
            self.assertTrue(item.__doc__, name)
            for member in vars(item).values() if isinstance(item, type) else ():
                if not getattr(member, "__name__", "__").startswith("__"):
                    self.assertTrue(member.__doc__, f"{name}.{member.__name__}")

    def test_version_is_that_of_the_document(self):
        self.assertIn(f'"generator": "touchline {touchline.__version__}"', touchline.load(support.DEMO).to_json())


@unittest.skipIf(NO_MYPY, NO_MYPY)
class Types(unittest.TestCase):
    def check(self, *arguments):
        # In an empty folder: what lies beside an installed package is not to be checked.
        with tempfile.TemporaryDirectory() as folder:
            ran = subprocess.run([sys.executable, "-m", *arguments], capture_output=True, text=True, check=False, cwd=folder)
        self.assertEqual(ran.returncode, 0, ran.stdout + ran.stderr)

    def test_the_package_is_strict(self):
        self.check("mypy", "--strict", "-p", "touchline")

    def test_the_stubs_are_those_of_the_module(self):
        with tempfile.NamedTemporaryFile("w", suffix=".txt") as allowed:
            # Types for type checkers alone.
            allowed.write("touchline._touchline.Click\ntouchline._touchline.__all__\ntouchline.interchange.Numbers\ntouchline.__main__\n")
            allowed.flush()
            self.check("mypy.stubtest", "touchline", "--allowlist", allowed.name, "--ignore-unused-allowlist")

    def test_a_users_script_is_checked(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "script.py")
            with open(path, "w", encoding="utf-8") as file:
                file.write(
                    "import touchline\n"
                    "document = touchline.load('x')\n"
                    "camera = document.camera(0)\n"
                    "assert camera is not None\n"
                    "pixels = touchline.project(camera, [[0.0, 0.0, 0.0]])\n"
                    "reveal_type(pixels)\n"
                )
            ran = subprocess.run([sys.executable, "-m", "mypy", "--strict", path], capture_output=True, text=True, check=False)
            self.assertEqual(ran.returncode, 0, ran.stdout)
            self.assertRegex(ran.stdout, "ndarray.*float64")


class Interchange(unittest.TestCase):
    def test_pitch_coordinates_go_there_and_back(self):
        field = touchline.field("soccer", length_m=100.0, width_m=64.0)
        points = np.random.default_rng(8).uniform(-30, 30, (50, 2))
        for origin in ("centre", "bottom_left", "top_left"):
            for size in (None, (1, 1), (120, 80)):
                there = interchange.to_pitch(points, field, origin, size)
                np.testing.assert_allclose(interchange.from_pitch(there, field, origin, size), points, atol=1e-9)
        np.testing.assert_allclose(interchange.to_pitch(points, field), points, rtol=1e-12)
        # The far right corner is at the top right of a map.
        np.testing.assert_allclose(interchange.to_pitch([[50, 32]], field, "top_left", (12000, 7000)), [[12000, 0]])
        np.testing.assert_allclose(interchange.to_pitch([[50, 32]], field, "bottom_left"), [[100, 64]])

    def test_keypoints(self):
        document = touchline.load(support.DEMO)
        camera = document.camera(0)
        found = interchange.keypoints(camera, document.field)
        self.assertEqual(found.xy.shape, (1, len(found.names), 2))
        for click in document[0]["clicks"]:
            row = found.names.index(click["landmark"])
            self.assertEqual(found.visible[0, row], 1.0)
            self.assertLess(np.hypot(*(found.xy[0, row] - click["image_px"])), 5.0)
        self.assertTrue((found.xy[found.visible == 0] == 0).all())

    @unittest.skipIf(NO_PANDAS, NO_PANDAS)
    def test_data_frame(self):
        document = touchline.load(support.DEMO)
        table = document.to_dataframe()
        self.assertEqual(len(table), len(document))
        solved = document.frames.solved
        np.testing.assert_array_equal(table["pan_deg"].notna(), solved)
        self.assertEqual(table["clicks"].sum(), len(document.frames.clicks["frame"]))
        self.assertEqual(table["image"][0], document[0]["image"])
        grades = document.frames.ground["grade"]
        np.testing.assert_array_equal(grades != "", solved & (document.frames.status != "rejected"))
        np.testing.assert_array_equal(table["grade"], grades)
        for area, grade in zip(document.frames.ground["visible_area_m"], grades, strict=True):
            self.assertEqual(area.shape[1], 2)
            self.assertIn(grade, ("", "none", "map", "speed"))


class Program(unittest.TestCase):
    @unittest.skipIf(support.NO_PROGRAM, support.NO_PROGRAM)
    def test_the_program_is_found(self):
        ran = subprocess.run([sys.executable, "-m", "touchline", "--version"], capture_output=True, text=True, check=False)
        self.assertEqual((ran.returncode, ran.stdout.split()[:2]), (0, ["touchline", touchline.__version__]), ran.stderr)

    def test_without_the_program_there_is_one_clear_line(self):
        environment = {**os.environ, "PATH": "", "TOUCHLINE": "", "HOME": "/nonexistent"}
        ran = subprocess.run(
            [sys.executable, "-m", "touchline"], capture_output=True, text=True, check=False, env=environment
        )
        if ran.returncode == 2 and "is not installed" in ran.stderr:
            self.assertEqual(ran.stderr.count("\n"), 1)
        else:
            self.skipTest("the program lies beside this Python")

    def test_a_plan_that_cannot_be_read_is_one_clear_line(self):
        with tempfile.NamedTemporaryFile("w", suffix=".json") as plan:
            plan.write("matches: []")
            plan.flush()
            for path in (plan.name, "missing.json"):
                ran = subprocess.run(
                    [sys.executable, "-m", "touchline.season", path, "--parts", "parts"],
                    capture_output=True,
                    text=True,
                    check=False,
                )
                self.assertEqual((ran.returncode, ran.stderr.count("\n")), (1, 1), ran.stderr)
                self.assertIn(f"touchline: cannot read the plan {path}: ", ran.stderr)


if __name__ == "__main__":
    unittest.main()
