"""Compares Kinora's denoiser with Intel's Open Image Denoise (OIDN).

    pip install numpy OpenEXR pyoidn
    python benches/denoisers.py target/release/kinora FOLDER

Frames are rendered into FOLDER, which takes an hour or two; those that are there are read. OIDN gets the samples of
Kinora's picture (the layer `samples`), with the layers of albedo and normals as its guides. Kinora's audits, an eighth
of the samples each, are extra; OIDN states no error and needs none. The last column gives OIDN as many samples more.

Both are compared with two references of other seeds. The product of the differences to both is the squared error
without the noise of the references. It is divided by the square of the reference plus 0.01, and is the mean over pixels
and channels: relMSE.

Flicker is the mean absolute change from frame to frame where nothing changes, as a share of the mean light there.
"""

import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import OpenEXR
from pyoidn import OIDN_FILTER_TYPE_RT, OIDN_FORMAT_FLOAT3, Device, Filter

ROOT = Path(__file__).resolve().parent.parent
SIZE = "320x180"
SAMPLES = (32, 128, 512)
SEEDS = (1, 2, 3)
# Each of the two references is the mean of every second one of these.
REFERENCES = range(1001, 1009)
REFERENCE_SAMPLES = 1024

# The sequence, its frame and options.
FRAMES = (
    ("field-orbit", 4, ()),
    ("light-show", 10, ()),
    ("room", 0, ("--integrator", "path")),
    ("field-dielectric", 8, ()),
)

# A still camera and still light. A small moon moves.
MOVING, STILLS, MOVING_OPTIONS = "room-moon", 10, ("--integrator", "path")


def sequence(folder, name):
    """A copy of a sequence whose EXR files have the layers that OIDN needs."""
    for part in ("sequences", "assets"):
        shutil.copytree(ROOT / part, folder / part, dirs_exist_ok=True)
    path = folder / "sequences" / f"{name}.ron"
    text = path.read_text()
    layers = "exr: (layers: [Normal, Albedo, Samples])"
    if "output: (" not in text:
        sys.exit(f"{name} has no output to which layers could be added")
    path.write_text(text.replace("output: (", f"output: ({layers}, ", 1))
    return path


def render(kinora, folder, name, command, options, output):
    """Renders a frame or frames, unless they are all there."""
    every = [output.replace("##", f"{frame:02}") for frame in range(STILLS)] if "##" in output else [output]
    if not all((folder / frame).is_file() for frame in every):
        words = [kinora, command, sequence(folder, name), *options, "-s", SIZE, "-q", "-o", folder / output]
        subprocess.run(words, check=True)


def channels(path):
    """The picture, its samples, albedo and normals."""
    with OpenEXR.File(str(path), separate_channels=True) as file:
        found = {name: channel.pixels for name, channel in file.channels().items()}
    return [np.stack([found[name] for name in names], axis=2).astype(np.float32) for names in CHANNELS]


CHANNELS = (
    ("R", "G", "B"),
    ("samples.R", "samples.G", "samples.B"),
    ("albedo.R", "albedo.G", "albedo.B"),
    ("N.X", "N.Y", "N.Z"),
)


class Oidn:
    """OIDN on the processor, at its highest quality."""

    def __init__(self):
        self.device = Device()
        self.device.commit()

    def run(self, images, **flags):
        images = {name: np.ascontiguousarray(image) for name, image in images.items()}
        output = np.empty_like(next(iter(images.values())))
        filtering = Filter(self.device, OIDN_FILTER_TYPE_RT)
        for name, image in {**images, "output": output}.items():
            filtering.set_image(name, image, OIDN_FORMAT_FLOAT3)
        for name, flag in flags.items():
            filtering.set_bool(name, flag)
        filtering.commit()
        filtering.execute()
        filtering.release()
        return output

    def denoise(self, samples, albedo, normal):
        """With guides as they are, and with guides that are denoised first."""
        albedo = np.clip(albedo, 0, 1)
        plain = self.run({"color": samples, "albedo": albedo, "normal": normal}, hdr=True)
        guides = {name: self.run({name: image}) for name, image in (("albedo", albedo), ("normal", normal))}
        return plain, self.run({"color": samples, **guides}, hdr=True, cleanAux=True)


def relative_error(picture, references):
    a, b = references
    return float(np.mean((picture - a) * (picture - b) / (((a + b) / 2) ** 2 + 0.01)))


def compare(kinora, folder, oidn):
    print("| frame | samples | without | Kinora | OIDN | OIDN, `cleanAux` | Kinora / OIDN | with its audits |")
    print("|---|---|---|---|---|---|---|---|")
    for name, frame, options in FRAMES:
        def shot(samples, seed, *more):
            output = f"{name}_{'ref' if samples == REFERENCE_SAMPLES else samples}_{seed}.exr"
            chosen = ("--frame", str(frame), "--samples", str(samples), "--seed", str(seed))
            render(kinora, folder, name, "poster", (*chosen, *options, *more), output)
            return channels(folder / output)

        long = [shot(REFERENCE_SAMPLES, seed, "--no-denoise")[0] for seed in REFERENCES]
        references = np.mean(long[::2], axis=0), np.mean(long[1::2], axis=0)
        for samples in SAMPLES:
            errors = []
            for seed in SEEDS:
                denoised, *inputs = shot(samples, seed, "--denoise")
                more = shot(samples * 5 // 4, seed, "--no-denoise")[1:]
                pictures = inputs[0], denoised, *oidn.denoise(*inputs), *oidn.denoise(*more)
                errors.append([relative_error(picture, references) for picture in pictures])
            means = np.mean(errors, axis=0)
            cells = [f"{1e4 * mean:.3g}" for mean in means[:4]]
            cells += [f"{means[1] / min(others):.2f}" for others in (means[2:4], means[4:])]
            print(f"| `{name}`, {frame} | {samples} | {' | '.join(cells)} |", flush=True)


def flicker(kinora, folder, oidn):
    def shots(prefix, *options):
        frames = ("--frames", f"0-{STILLS - 1}", *MOVING_OPTIONS, *options)
        render(kinora, folder, MOVING, "render", frames, f"{prefix}_##.exr")
        return [channels(folder / f"{prefix}_{frame:02}.exr") for frame in range(STILLS)]

    # Without noise of their own, frames are equal to the last bit where the moon has no part in the light.
    alike = np.stack([shot[0] for shot in shots("still", "--samples", "16", "--no-denoise")])
    still = (alike == alike[0]).all(axis=(0, 3))
    print(f"\nFlicker of the {100 * still.mean():.0f} % of the pixels that do not change, in % of their light:\n")
    print("| noise | samples | without | Kinora, each frame alone | with neighbours | OIDN | OIDN, `cleanAux` |")
    print("|---|---|---|---|---|---|---|")
    for noise, prefix, options in (("varies", "varied", ("--vary-noise",)), ("stays", "steady", ())):
        for samples in SAMPLES[:2]:
            modes = (("alone", "--denoise=alone"), ("auto", "--denoise"))
            alone, auto = (
                shots(f"{prefix}_{samples}_{name}", "--samples", str(samples), mode, *options) for name, mode in modes
            )
            frames = ((one[0], *other) for one, other in zip(alone, auto))
            films = zip(*((own, one, both, *oidn.denoise(own, *guides)) for one, both, own, *guides in frames))
            changes = (np.abs(np.diff(np.stack(film), axis=0))[:, still].mean() for film in films)
            cells = " | ".join(f"{100 * change / alike[0][still].mean():.2f}" for change in changes)
            print(f"| {noise} | {samples} | {cells} |", flush=True)


def main():
    kinora, folder = sys.argv[1], Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    oidn = Oidn()
    compare(kinora, folder, oidn)
    flicker(kinora, folder, oidn)


if __name__ == "__main__":
    main()
