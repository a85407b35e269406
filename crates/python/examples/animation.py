"""Draws a scene that moves into a video.

    python animation.py SCENE VIDEO [WIDTHxHEIGHT] [FPS]

The ending of VIDEO chooses: .y4m (YUV4MPEG2, which every encoder reads), .png (an animated PNG, by Pillow), or what
ffmpeg makes of it, such as .mp4, if it is there.
"""

import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path

import energywave as ew
import numpy as np

#: Luma and colour differences of Rec. 709, 8 bits, limited range.
YUV = np.array([[0.2126, 0.7152, 0.0722], [-0.1146, -0.3854, 0.5], [0.5, -0.4542, -0.0458]])
SCALE, OFFSET = np.array([219.0, 224.0, 224.0]), np.array([16.0, 128.0, 128.0])


def write_y4m(file, pictures, fps) -> None:
    """Writes pictures as YUV4MPEG2 with colours of every pixel (4:4:4)."""
    for number, picture in enumerate(pictures):
        if number == 0:
            height, width = picture.shape[:2]
            header = f"YUV4MPEG2 W{width} H{height} F{fps.numerator}:{fps.denominator} Ip A1:1 C444\n"
            file.write(header.encode())
        planes = (picture / 255.0) @ YUV.T * SCALE + OFFSET
        file.write(b"FRAME\n" + np.rint(planes).astype(np.uint8).transpose(2, 0, 1).tobytes())


@contextmanager
def encoder(path: Path):
    """Opens a file, or ffmpeg, for YUV4MPEG2."""
    if path.suffix == ".y4m":
        with open(path, "wb") as file:
            yield file
        return
    command = ["ffmpeg", "-loglevel", "error", "-y", "-i", "-", "-pix_fmt", "yuv420p", str(path)]
    with subprocess.Popen(command, stdin=subprocess.PIPE) as process:
        yield process.stdin
    if process.returncode != 0:
        raise SystemExit(process.returncode)


def main(scene: str, path: Path, size: str, fps: int) -> None:
    opened = ew.open_scene(scene)
    width, height = map(int, size.split("x"))
    frames = ew.animate(opened, fps=fps, size=(width, height))
    pictures = (ew.tone_map(frame, opened).pixels[..., :3] for frame in frames)
    if path.suffix == ".png":
        from PIL import Image

        first, *others = [Image.fromarray(picture) for picture in pictures]
        first.save(path, save_all=True, append_images=others, duration=1000 / fps, loop=0)
    else:
        with encoder(path) as file:
            write_y4m(file, pictures, frames.fps)
    print(f"{path}: {len(frames.frames)} frames of {size}")


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]), *(sys.argv[3:4] or ["640x360"]), int((sys.argv[4:5] or [30])[0]))
