"""Writes Zarr stores into tests/data/formats, with the `zarr` and `ome-zarr` libraries.

    pip install numpy zarr ome-zarr
    python tests/data/generate/zarr_images.py
"""

import pathlib
import shutil
import tempfile
import zipfile

import numcodecs
import numpy as np
import zarr
from ome_zarr.format import FormatV04, FormatV05
from ome_zarr.writer import write_multiscale
from zarr.codecs import BloscCodec, BytesCodec, Crc32cCodec, GzipCodec, ShardingCodec, TransposeCodec, ZstdCodec

from phantom import Expected, phantom, zipped

EXPECTED = Expected()


def store(name, write):
    """Runs `write` on a new folder and packs it."""
    with tempfile.TemporaryDirectory() as folder:
        write(folder)
        root = pathlib.Path(folder)
        files = sorted(path for path in root.rglob("*") if path.is_file())
        zipped(name, [(path.relative_to(root).as_posix(), path.read_bytes()) for path in files], zipfile.ZIP_STORED)


def image(name, levels, axes, fmt, transforms, **options):
    def write(folder):
        group = zarr.open_group(folder, mode="w", zarr_format=fmt.zarr_format)
        write_multiscale(levels, group, fmt=fmt, axes=axes, coordinate_transformations=transforms, storage_options=options)

    store(name, write)


def space(name, unit="micrometer"):
    return {"name": name, "type": "space", "unit": unit}


def array2(name, data, **options):
    store(name, lambda folder: zarr.create_array(folder, data=data, zarr_format=2, **options))
    EXPECTED.add(name, data)


def array3(name, data, **options):
    store(name, lambda folder: zarr.create_array(folder, data=data, zarr_format=3, **options))
    EXPECTED.add(name, data)


def main():
    p = phantom().astype(np.uint16)
    halved = p[::2, ::2, ::2]

    # Two levels, micrometres, with the z axis last but one.
    steps = [[{"type": "scale", "scale": [2.0, 0.5, 0.25]}, {"type": "translation", "translation": [10.0, -3.0, 1.0]}],
             [{"type": "scale", "scale": [4.0, 1.0, 0.5]}, {"type": "translation", "translation": [10.0, -3.0, 1.0]}]]
    for name, fmt in (("ome04.zarr.zip", FormatV04()), ("ome05.zarr.zip", FormatV05())):
        image(name, [p, halved], [space("z"), space("y"), space("x")], fmt, steps, chunks=(3, 4, 5))
        EXPECTED.add(name, p, np.diag([0.25, 0.5, 2.0]) * 1e-3, np.array([1, -3, 10]) * 1e-3)
        EXPECTED.add(name, halved, np.diag([0.5, 1.0, 4.0]) * 1e-3, np.array([1, -3, 10]) * 1e-3, level=1)

    # Times and channels.
    five = np.stack([np.stack([p + 1000 * t + 100 * c for c in range(3)]) for t in range(2)])
    axes = [{"name": "t", "type": "time", "unit": "second"}, {"name": "c", "type": "channel"},
            space("z", "millimeter"), space("y", "millimeter"), space("x", "millimeter")]
    image("five.zarr.zip", [five], axes, FormatV05(), [[{"type": "scale", "scale": [1.0, 1.0, 3.0, 2.0, 1.5]}]],
          chunks=(1, 2, 3, 4, 5))
    for t, c in ((0, 0), (1, 2)):
        EXPECTED.add("five.zarr.zip", five[t, c], np.diag([1.5, 2.0, 3.0]), timestep=t, channel=c)

    # Arrays alone, version 2.
    signed = p.astype(np.int16) - 300
    for shuffle in (numcodecs.Blosc.NOSHUFFLE, numcodecs.Blosc.SHUFFLE, numcodecs.Blosc.BITSHUFFLE):
        for codec in ("lz4", "zlib", "zstd"):
            # Large enough for streams that are split.
            big = np.kron(p, np.ones((2, 2, 2))).astype(np.int32) * 3
            array2(f"blosc_{codec}_{shuffle}.zarr.zip", big, chunks=(5, 12, 8), compressors=numcodecs.Blosc(codec, 5, shuffle))
    array2("gzip2.zarr.zip", signed, chunks=(2, 3, 7), compressors=numcodecs.GZip(5), order="F")
    array2("zlib2.zarr.zip", signed.astype(">i2"), chunks=(5, 6, 4), compressors=numcodecs.Zlib(5))
    array2("bz2.zarr.zip", (p / 4).astype(np.float16), chunks=(5, 6, 4), compressors=numcodecs.BZ2(5))
    array2("lz4.zarr.zip", p.astype(np.float64) / 8, chunks=(5, 6, 4), compressors=numcodecs.LZ4())
    array2("none2.zarr.zip", p.astype(np.uint8), chunks=(5, 6, 4), compressors=None)

    # Version 3.
    array3("zstd3.zarr.zip", signed, chunks=(2, 3, 4), compressors=ZstdCodec(level=5))
    array3("gzip3.zarr.zip", signed, chunks=(2, 3, 4), compressors=[GzipCodec(level=5), Crc32cCodec()])
    array3("big3.zarr.zip", (p / 2).astype(np.float32), chunks=(5, 3, 7), serializer=BytesCodec(endian="big"),
           filters=[TransposeCodec(order=(1, 2, 0))], compressors=BloscCodec(cname="lz4", shuffle="shuffle", typesize=4))
    for location in ("start", "end"):
        array3(f"shards_{location}.zarr.zip", signed, chunks=(4, 4, 4),
               serializer=ShardingCodec(chunk_shape=(2, 2, 4), codecs=[BytesCodec(), ZstdCodec()],
                                        index_location=location), compressors=None)

    # Chunks that are not there.
    def sparse(folder):
        array = zarr.create_array(folder, shape=p.shape, chunks=(5, 6, 4), dtype="f4", fill_value=-1.5, zarr_format=3)
        array[:, :, 4:] = 2.5

    store("sparse.zarr.zip", sparse)
    EXPECTED.add("sparse.zarr.zip", np.where(np.arange(7) > 3, 2.5, -1.5) * np.ones(p.shape))
    EXPECTED.write("expected_zarr.json")


main()
