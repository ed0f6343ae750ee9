"""Progress, interrupts, and the command."""

import importlib.metadata
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import kinora

BALL = """(
    timeline: (frames: 6, fps: 24, keys: Frames),
    output: (size: (32, 18)),
    camera: (position: (0, 0, 5)),
    lights: { "lamp": Point(position: (3, 4, 5)) },
    objects: { "ball": (shape: Sphere(), translation: [(0, (0, 0, 0)), (3, (1, 0, 0))]) },
)"""

# Half a minute or more, in many frames.
LONG = BALL.replace("frames: 6", "frames: 100000").replace("(3, (1", "(99999, (1")


class Progress(unittest.TestCase):
    def test_a_function_hears_of_every_frame_once_at_most(self):
        heard = []
        kinora.render(BALL, size=(64, 36), antialias=3, progress=lambda *counts: heard.append(counts))
        self.assertEqual(heard[-1], (6, 6))
        self.assertEqual(heard, sorted(set(heard)))

    def test_bars_of_tqdm(self):
        from tqdm import tqdm

        with open(os.devnull, "w") as nowhere, tqdm(file=nowhere) as bar:
            kinora.render(BALL, progress=bar)
            self.assertEqual((bar.n, bar.total), (6, 6))
        script = "import kinora, sys; kinora.render(sys.argv[1], progress=True)"
        run = subprocess.run([sys.executable, "-c", script, BALL], capture_output=True, text=True, check=True)
        self.assertIn("6/6", run.stderr)

    def test_other_threads_run_meanwhile(self):
        counted, stop = [0], threading.Event()

        def count():
            while not stop.is_set():
                counted[0] += 1
                time.sleep(0.001)

        thread = threading.Thread(target=count)
        thread.start()
        try:
            start = counted[0]
            began = time.monotonic()
            kinora.render(BALL, size=(96, 54), antialias=4, threads=1)
            took = time.monotonic() - began
            self.assertGreater(counted[0] - start, 20 * took)
        finally:
            stop.set()
            thread.join()


class Interrupts(unittest.TestCase):
    def test_exceptions_of_the_function_end_the_run(self):
        def refuse(done, total):
            raise LookupError("enough")

        began = time.monotonic()
        with self.assertRaises(LookupError):
            kinora.render(LONG, progress=refuse)
        self.assertLess(time.monotonic() - began, 15)

    def test_ctrl_c_raises_keyboard_interrupt(self):
        timer = threading.Timer(0.5, os.kill, [os.getpid(), signal.SIGINT])
        timer.start()
        began = time.monotonic()
        with self.assertRaises(KeyboardInterrupt):
            kinora.render(LONG)
        self.assertLess(time.monotonic() - began, 15)
        # The library works on.
        self.assertEqual(len(kinora.render(BALL)), 6)

    def test_finished_files_remain(self):
        with tempfile.TemporaryDirectory() as folder:
            def refuse(done, total):
                # Frames that are traced together count before their files appear.
                if os.path.exists(os.path.join(folder, "f_00001.png")):
                    raise LookupError("enough")

            with self.assertRaises(LookupError):
                kinora.render_files(LONG, os.path.join(folder, "f_#####.png"), frames=range(20000), progress=refuse)
            files = os.listdir(folder)
            self.assertGreaterEqual(len(files), 2)
            self.assertTrue(all(re.fullmatch(r"f_\d{5}\.png", file) for file in files), files)


class Command(unittest.TestCase):
    def test_the_script_and_the_module_are_the_command(self):
        script = pathlib.Path(sys.executable).with_name("kinora")
        version = importlib.metadata.version("kinora-render")
        self.assertEqual(kinora.__version__, version)
        for command in [[script], [sys.executable, "-m", "kinora"]]:
            run = subprocess.run([*command, "--version"], capture_output=True, text=True)
            self.assertEqual((run.returncode, run.stdout), (0, f"kinora {version}\n"))
            run = subprocess.run([*command, "check", "missing.ron"], capture_output=True, text=True)
            self.assertEqual(run.returncode, 2)
            self.assertIn("there is no file missing.ron", run.stderr)

    def test_an_interrupted_command_says_how_to_continue(self):
        with tempfile.TemporaryDirectory() as folder:
            pathlib.Path(folder, "long.ron").write_text(LONG)
            script = str(pathlib.Path(sys.executable).with_name("kinora"))
            options = ["render", "long.ron", "--frames", "0-20000", "-o", "f_#####.png"]
            with subprocess.Popen([script, *options], cwd=folder, stderr=subprocess.PIPE, text=True) as run:
                while len(list(pathlib.Path(folder).glob("f_*.png"))) < 2 and run.poll() is None:
                    time.sleep(0.05)
                run.send_signal(signal.SIGINT)
                told = run.stderr.read()
            self.assertEqual(run.returncode, 130, told)
            self.assertIn("to continue: kinora render long.ron --frames 0-20000 -o 'f_#####.png'", told)
            self.assertNotIn("Traceback", told)

    def test_the_wheel_holds_its_licences_and_types(self):
        files = [str(file) for file in importlib.metadata.files("kinora-render")]
        for name in ["LICENSE-MIT", "LICENSE-APACHE", "LICENSES-DEPENDENCIES.txt", "py.typed", "__init__.pyi"]:
            self.assertTrue(any(file.endswith(name) for file in files), (name, files))


if __name__ == "__main__":
    unittest.main()
