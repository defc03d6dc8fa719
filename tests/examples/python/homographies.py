"""Pictures with the homographies of their ground, for a training loop of PyTorch.

usage: homographies.py DOC

`Homographies` is what `torch.utils.data.DataLoader` takes: it has a length and items. torch itself is not needed to make one.
"""

import sys

import numpy as np
import touchline


class Homographies:
    """The solved frames of a document: (picture, homography from the ground in m to its pixels).

    Pictures are (3, height, width), float32, 0 to 1, red first; homographies (3, 3), float32, scaled to a length of 1.
    `stride`: takes every second, third, … row and column of a picture; the homographies follow.
    """

    def __init__(self, path, status=("reference",), stride=1):
        self.document = touchline.load(path)
        frames = self.document.frames
        self.rows = np.flatnonzero(frames.solved & np.isin(frames.status, status))
        # The centre (c + 0.5, r + 0.5) of a pixel that is kept was (stride c + 0.5, stride r + 0.5).
        shift = 0.5 - 0.5 / stride
        reduced = np.array([[1 / stride, 0, shift], [0, 1 / stride, shift], [0, 0, 1]])
        homographies = reduced @ frames.H[self.rows]
        self.homographies = (homographies / np.linalg.norm(homographies, axis=(1, 2), keepdims=True)).astype(np.float32)
        self.stride = stride

    def __len__(self):
        return len(self.rows)

    def __getitem__(self, index):
        picture = self.document.image(int(self.rows[index]))[:: self.stride, :: self.stride]
        return np.moveaxis(picture, 2, 0).astype(np.float32) / 255, self.homographies[index]


def main(path):
    data = Homographies(path, stride=4)
    print(f"{len(data)} pictures of shape {data[0][0].shape}")
    try:
        from torch.utils.data import DataLoader
    except ImportError:
        print("torch is not installed: the items are NumPy arrays")
        return
    for pictures, homographies in DataLoader(data, batch_size=4, shuffle=True):
        print(tuple(pictures.shape), tuple(homographies.shape))


if __name__ == "__main__":
    main(*sys.argv[1:])
