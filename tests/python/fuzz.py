"""Calls the module's functions with random arguments: each must return or raise an ordinary exception.

usage: fuzz.py CALLS [SEED]

A crash of the interpreter, a `PanicException` and a RuntimeError that reports an internal error end it with the call that did it.
"""

import faulthandler
import os
import random
import sys
import tempfile

import numpy as np
import touchline

DEMO = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "projects", "demo")
NUMBERS = [0, 1, -1, 2, 0.5, -0.0, 1e-320, 1e308, -1e308, 1e9, float("nan"), float("inf"), -float("inf"), 2**31, 2**63, -(2**70)]
NAMES = ["", "soccer", "centre_mark", "halfway_line", "main", "part", "whole", "k1", "draft", "rejected", "blur", "\0", "é" * 9, "tennis"]
DTYPES = ["f8", "f4", ">f8", "i4", "u1", "?", "c16", "U3", "O", "M8[s]", "f2"]
SHAPES = [(), (0,), (2,), (3,), (2, 2), (3, 3), (4, 2), (0, 3), (5, 3), (5, 4), (2, 3, 4), (8, 8, 3), (16, 9, 3), (1, 1, 1, 1)]


class Arguments:
    """Draws arguments: of the kinds that fit, and of all others."""

    def __init__(self, seed):
        self.random = random.Random(seed)
        self.numpy = np.random.default_rng(seed)
        self.document = touchline.load(DEMO)
        self.base = self.document.base()
        self.field = touchline.field()
        self.forest = touchline.Forest.train(self.document, trees=1, measured=False)
        self.image = self.document.image(0)

    def number(self):
        return self.random.choice([*NUMBERS, self.random.uniform(-100, 2000), self.random.randrange(-5, 40)])

    def array(self):
        shape, dtype = self.random.choice(SHAPES), self.random.choice(DTYPES)
        scale = self.random.choice([1.0, 100.0, 1e6, 1e300])
        array = self.numpy.normal(0, scale, shape)
        if array.size and self.random.random() < 0.3:
            array.flat[self.random.randrange(array.size)] = self.random.choice([np.nan, np.inf, -np.inf])
        with np.errstate(all="ignore"):
            array = np.nan_to_num(array, posinf=9, neginf=-9).clip(0, 200).astype(dtype) if dtype != "f8" else array
        array = np.asarray(array)
        way = self.random.randrange(6)
        if way == 0 and array.ndim:
            array = array[::-1]
        elif way == 1:
            array = np.asfortranarray(array)
        elif way == 2 and array.ndim:
            array = np.repeat(array, 2, axis=0)[::2]
        elif way == 3 and array.dtype == np.float64:
            array = np.frombuffer(b"\0" + array.tobytes(), np.uint8)[1:].view(np.float64).reshape(array.shape)
        elif way == 4:
            array.setflags(write=False)
        return array if self.random.random() < 0.8 else array.tolist()

    def click(self):
        name = self.random.choice([*self.field.landmarks, *self.field.lines, *NAMES])
        click = {self.random.choice(["landmark", "line", "x"]): name}
        if self.random.random() < 0.95:
            click["image_px"] = self.random.choice([self.numpy.uniform(0, 700, 2), [self.number(), self.number()], self.number()])
        if self.random.random() < 0.1:
            click["check"] = self.random.choice([True, 1, None])
        return click

    def camera(self):
        try:
            return self.base.camera(self.random.uniform(-60, 60), self.random.uniform(-30, 5), self.random.uniform(200, 9000))
        except ValueError:
            return None

    def any(self):
        """Something of any kind."""
        kinds = [
            self.number, self.array, self.click, self.camera,
            lambda: [self.click() for _ in range(self.random.randrange(6))],
            lambda: self.random.choice(NAMES),
            lambda: self.random.choice([None, True, b"x", {}, [], (), object(), {1: 2}, [[1, 2], [3]], len, 1j]),
            lambda: self.random.choice([self.document, self.base, self.field, self.document.frames, self.forest]),
            lambda: {self.random.choice([*self.field.lines, *NAMES]): self.array()},
            lambda: (self.number(), self.number()),
        ]
        return self.random.choice(kinds)()


def calls(draw):
    """Every function and method with a maker of arguments that may fit."""
    points, frame = draw.array, lambda: draw.random.choice([0, 1, -1, 99, "x", draw.document.frames[0]["id"], draw.number()])
    clicks = lambda: [draw.click() for _ in range(draw.random.randrange(7))]  # noqa: E731
    text = lambda: draw.random.choice([*NAMES, draw.document.to_json()[: draw.random.randrange(400)], '{"version": 99}'])  # noqa: E731
    nowhere = lambda: draw.random.choice(["/nonexistent/x", "", "\0", ".", "/dev/null", "/etc/hostname"])  # noqa: E731
    lines = lambda: {draw.random.choice([*draw.field.lines, *NAMES]): draw.array() for _ in range(3)}  # noqa: E731
    small = lambda: draw.random.choice([draw.array(), draw.image[:90, :160], draw.image.astype("f4")])  # noqa: E731
    return [
        (touchline.project, (draw.camera, points)),
        (touchline.unproject, (draw.camera, points, draw.number)),
        (touchline.homography, (draw.camera,)),
        (touchline.Base, (points, lambda: (draw.number(), draw.number()), points, points)),
        (draw.base.camera, (draw.number, draw.number, draw.number)),
        (touchline.two_point, (lambda: draw.base, points, points)),
        (touchline.solve_frame, (lambda: draw.base, clicks)),
        (touchline.iou, (draw.camera, draw.camera, lambda: draw.field, lambda: draw.random.choice(["part", "whole", "x"]))),
        (touchline.jac, (draw.camera, lines, lambda: draw.field, draw.number)),
        (touchline.visible_lines, (draw.camera,)),
        (touchline.field, (lambda: draw.random.choice(NAMES),)),
        (draw.field.line, (lambda: draw.random.choice([*draw.field.lines, *NAMES]), draw.number)),
        (draw.document.set_clicks, (frame, clicks)),
        (draw.document.set_masks, (frame, points)),
        (draw.document.set_status, (frame, lambda: draw.random.choice(NAMES), lambda: draw.random.choice(NAMES))),
        (draw.document.camera, (frame,)),
        (draw.document.field_of, (frame,)),
        (draw.document.image, (frame,)),
        (draw.document.base, (lambda: draw.random.choice(NAMES),)),
        (draw.document.__getitem__, (frame,)),
        (draw.document.frames.__getitem__, (frame,)),
        (touchline.Document.from_json, (text,)),
        (touchline.load, (nowhere,)),
        (touchline.Forest.load, (nowhere,)),
        (draw.forest.relocalize, (small,)),
        (touchline.snap, (small, draw.camera)),
        (touchline.calibrate, (nowhere,)),
        (touchline.interchange.to_pitch, (points, lambda: draw.field, lambda: draw.random.choice(["centre", "top_left", "x"]))),
        (touchline.interchange.keypoints, (draw.camera, lambda: draw.field)),
    ]


# Called now and then: they take long, or write.
def rare_calls(draw, folder):
    return [
        lambda: touchline.solve(draw.document),
        lambda: touchline.estimate_base(draw.document, distortion="none"),
        lambda: draw.document.save(os.path.join(folder, draw.random.choice(["a.json", "b/", "", "c/d/e.json"])), True),
        lambda: draw.document.frames.R.sum() + draw.document.frames.H.sum() + len(draw.document.frames.clicks["name"]),
        lambda: draw.document.to_json(),
        lambda: touchline.track(draw.document, frames=(draw.random.randrange(9), draw.random.randrange(9))),
    ]


def main(count, seed=0):
    faulthandler.enable()
    draw = Arguments(seed)
    outcomes = {}
    with tempfile.TemporaryDirectory() as folder:
        rare = rare_calls(draw, folder)
        known = calls(draw)
        for index in range(count):
            function, makers = draw.random.choice(known)
            arguments = tuple(make() if draw.random.random() < 0.85 else draw.any() for make in makers)
            # Also too few, and unknown names.
            if draw.random.random() < 0.03:
                arguments = arguments[:-1]
            named = {draw.random.choice(["field", "x", "bgr", "k1"]): draw.any()} if draw.random.random() < 0.05 else {}
            if named.get("field") is not None and function is touchline.calibrate:
                named = {}
            try:
                if index % 1000 == 999:
                    function, arguments = draw.random.choice(rare), ()
                    function()
                else:
                    function(*arguments, **named)
                outcome = "returned"
            except Exception as error:
                if isinstance(error, RuntimeError) and "internal error" in str(error):
                    sys.exit(f"call {index} of seed {seed}: {function} {arguments!r} {named!r}: {error}")
                outcome = type(error).__name__
            except BaseException as error:
                sys.exit(f"call {index} of seed {seed}: {function} {arguments!r} {named!r}: {type(error).__name__}: {error}")
            outcomes[outcome] = outcomes.get(outcome, 0) + 1
    print(f"{count} calls:", ", ".join(f"{count} {name}" for name, count in sorted(outcomes.items())))


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
