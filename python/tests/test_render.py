"""What `kinora.render` takes and returns."""

import base64
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest
from fractions import Fraction

import kinora
import numpy

SEQUENCES = pathlib.Path(os.environ["KINORA_SEQUENCES"])

BALL = """(
    timeline: (frames: 4, fps: 24, keys: Frames),
    output: (size: (32, 18)),
    background: "#336699",
    camera: (position: (0, 0, 5)),
    lights: { "lamp": Point(position: (3, 4, 5)) },
    objects: { "ball": (shape: Sphere(), translation: [(0, (0, 0, 0)), (3, (1, 0, 0))]) },
)"""

BALL_DICT = {
    "timeline": {"frames": 4, "fps": 24, "keys": "Frames"},
    "output": {"size": [32, 18]},
    "background": "#336699",
    "camera": {"position": [0, 0, 5]},
    "lights": {"lamp": {"Point": {"position": numpy.array([3, 4, 5])}}},
    "objects": {
        "ball": {"shape": {"Sphere": {}}, "translation": [[0, [0, 0, 0]], [numpy.int64(3), [1, 0, 0]]]},
    },
}

BACKGROUND = [0x33, 0x66, 0x99]


class Folder(unittest.TestCase):
    """A test in an empty working directory."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(folder.name)


class Sources(Folder):
    def test_a_text_a_dict_json_and_paths_are_the_same_pictures(self):
        text = kinora.render(BALL)
        self.assertEqual([frame.shape for frame in text], [(18, 32, 3)] * 4)
        self.assertEqual({frame.dtype for frame in text}, {numpy.dtype("uint8")})
        self.assertEqual(text[0][0, 0].tolist(), BACKGROUND)
        self.assertNotEqual(text[0][9, 16].tolist(), BACKGROUND)
        self.assertFalse(numpy.array_equal(text[0], text[3]))
        path = pathlib.Path("ball (1).ron")
        path.write_text(BALL)
        as_json = subprocess.run([*COMMAND, "convert", path], check=True, capture_output=True, text=True).stdout
        for other in [BALL_DICT, as_json, path, str(path)]:
            self.assertTrue(numpy.array_equal(numpy.array(text), numpy.array(kinora.render(other))), other)

    def test_shipped_sequences_find_their_files(self):
        frames = kinora.render(SEQUENCES / "pressure.ron", frames=10, size=(24, 24), samples=1)
        self.assertEqual(len(frames), 1)
        self.assertGreater(int(frames[0].max()) - int(frames[0].min()), 50)

    def test_texts_find_files_in_a_folder(self):
        os.mkdir("meshes")
        pathlib.Path("meshes/t.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        text = BALL.replace("Sphere()", 'Mesh(file: "t.obj")')
        self.assertEqual(len(kinora.render(text, folder="meshes")), 4)
        with self.assertRaises(kinora.SequenceError):
            kinora.render(text)


class Settings(Folder):
    def test_keywords_are_the_options_of_the_command(self):
        frames = kinora.render(BALL, size=(16, 9), fps=12, samples=3, seed=7, threads=1, antialias=1)
        self.assertEqual((frames.size, frames.fps, len(frames)), ((16, 9), 12, 2))
        self.assertEqual(frames.times, [0, Fraction(1, 12)])
        self.assertEqual(kinora.render(BALL, size="16x9", frames=0, transparent=True)[0].shape, (9, 16, 4))
        bright = kinora.render(BALL, frames=0, exposure=2)
        self.assertGreater(bright[0].mean(), frames[0].mean() + 20)

    def test_wrong_keywords_say_what_is_right(self):
        for keywords, error, part in [
            ({"samples": 0}, ValueError, "samples=0: write a whole number of samples, 1 to"),
            ({"size": (0, 5)}, ValueError, "size=0x5: write width and height"),
            ({"sample": 4}, TypeError, "there is no keyword sample; did you mean samples?"),
            ({"noise": 0.1, "samples": 4}, ValueError, "noise cannot be used with samples"),
            ({"frames": 4}, ValueError, "there is no frame 4: the sequence has the frames 0 to 3"),
            ({"frames": []}, ValueError, "no frames"),
            ({"frames": "9"}, ValueError, "9"),
            ({"progress": 3}, TypeError, "progress is True"),
        ]:
            with self.subTest(keywords), self.assertRaises(error) as raised:
                kinora.render(BALL, **keywords)
            self.assertIn(part, str(raised.exception))

    def test_frames_are_selected(self):
        for frames, expected in [
            (None, [0, 1, 2, 3]),
            (2, [2]),
            (-1, [3]),
            ([3, 0], [3, 0]),
            (slice(None, None, 2), [0, 2]),
            (range(1, 3), [1, 2]),
            (numpy.array([1]), [1]),
            ("1-3:2", [1, 3]),
        ]:
            self.assertEqual(kinora.render(BALL, frames=frames, size=(4, 4)).numbers, expected)

    def test_light_is_linear(self):
        frames = kinora.render(BALL, frames=[0, 1], linear=True, exposure=1)
        light = frames.linear[0]
        self.assertEqual((light.shape, light.dtype), ((18, 32, 3), numpy.dtype("float32")))
        # Radiance is before exposure.
        srgb = numpy.array(BACKGROUND) / 255
        self.assertTrue(numpy.allclose(light[0, 0], ((srgb + 0.055) / 1.055) ** 2.4, atol=1e-6))
        self.assertIsNone(kinora.render(BALL, frames=0).linear)


class Errors(Folder):
    def test_mistakes_have_their_places(self):
        with self.assertRaises(kinora.SequenceError) as raised:
            kinora.render(BALL.replace("(32, 18)", "(32, 0)").replace("Sphere()", "Sphere(radius: -1)"))
        error = raised.exception
        self.assertEqual((error.path, error.line, error.field), ("sequence.ron", 3, "size"))
        self.assertEqual(BALL.splitlines()[2][error.column - 1 :][:2], "(3" if error.column == 20 else "18")
        self.assertEqual([fault["line"] for fault in error.faults], [3, 7])
        self.assertIn("radius", error.faults[1]["message"])
        self.assertIn("--> sequence.ron:3", str(error))
        self.assertIsInstance(error, ValueError)

    def test_mistakes_in_dicts_have_places_in_their_json(self):
        with self.assertRaises(kinora.SequenceError) as raised:
            kinora.render({**BALL_DICT, "background": "#33"})
        self.assertEqual((raised.exception.path, raised.exception.field), ("sequence.json", "background"))
        with self.assertRaises(TypeError) as raised:
            kinora.render({"background": object()})
        self.assertIn("cannot hold a object", str(raised.exception))

    def test_files_that_cannot_be_read_are_named(self):
        with self.assertRaises(kinora.SequenceError) as raised:
            kinora.render("missing.ron")
        error = raised.exception
        self.assertEqual((error.path, error.line, error.column, error.field), ("missing.ron", None, None, None))
        self.assertEqual(error.faults, [])
        self.assertIn("missing.ron", str(error))

    def test_frames_that_cannot_be_made(self):
        with self.assertRaises(ValueError) as raised:
            kinora.render(BALL, frames=0).save("a.tiff")
        self.assertIn("tiff", str(raised.exception))
        with self.assertRaises(kinora.RenderError) as raised:
            kinora.render(BALL).save("one.png")
        self.assertIn("one_####.png", str(raised.exception))


class Results(Folder):
    def test_saved_animations_are_those_of_the_command(self):
        pathlib.Path("ball.ron").write_text(BALL)
        frames = kinora.render("ball.ron")
        for name in ["a.gif", "a.apng", "a.webp", "a.mp4", "f_##.jpg"]:
            subprocess.run([*COMMAND, "render", "ball.ron", "-q", "-o", f"command/{name}"], check=True)
            self.assertEqual(frames.save(pathlib.Path("python") / name), [])
            own, others = [pathlib.Path(folder, name.replace("##", "02")) for folder in ("python", "command")]
            self.assertEqual(own.read_bytes(), others.read_bytes(), name)

    def test_changed_frames_are_saved(self):
        frames = kinora.render(BALL, frames=[0, 1])
        frames[1][:] = 255
        frames.save("f_#.ppm")
        self.assertEqual(set(pathlib.Path("f_1.ppm").read_bytes()[-32 * 18 * 3 :]), {255})
        self.assertNotEqual(set(pathlib.Path("f_0.ppm").read_bytes()[-32 * 18 * 3 :]), {255})

    def test_notebooks_show_gifs_and_pictures(self):
        frames = kinora.render(BALL)
        html = frames._repr_html_()
        self.assertTrue(html.startswith('<img width="32" height="18" src="data:image/gif;base64,'))
        self.assertTrue(base64.b64decode(html.split(",")[1].split('"')[0]).startswith(b"GIF89a"))
        bundle = frames._repr_mimebundle_()
        self.assertEqual((set(bundle), bundle["text/html"]), ({"text/plain", "text/html"}, html))
        self.assertEqual(bundle["text/plain"], "<kinora.Animation 'sequence': 4 frames, 32x18, 24 fps>")
        still = kinora.render(BALL, frames=0)._repr_mimebundle_()
        self.assertTrue(base64.b64decode(still["image/png"]).startswith(b"\x89PNG"))
        self.assertIn("<video", frames.html("mp4"))
        self.assertIn(b"ftyp", frames.encode("mp4")[:12])
        with self.assertRaises(ValueError):
            frames.html("bmp")

    def test_frames_are_a_sequence_of_arrays(self):
        frames = kinora.render(BALL)
        self.assertEqual(numpy.asarray(frames).shape, (4, 18, 32, 3))
        self.assertIs(frames[-1], frames[3])
        self.assertEqual(len(frames[1:3]), 2)

    def test_files_are_rendered_like_the_command_does(self):
        done = []
        files = kinora.render_files(
            BALL, "f_##.png", pathlib.Path("a.gif"), frames=[0, 1], progress=lambda *counts: done.append(counts)
        )
        self.assertEqual(files, ["f_##.png", "a.gif"])
        self.assertEqual(sorted(os.listdir()), ["a.gif", "f_00.png", "f_01.png"])
        self.assertEqual(done[-1], (2, 2))
        with self.assertRaises(TypeError):
            kinora.render_files(BALL)


COMMAND = [sys.executable, "-m", "kinora"]

if __name__ == "__main__":
    unittest.main()
