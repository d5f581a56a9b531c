"""Writes tests/data/transport: scenes of scattering media, and what Mitsuba 3 makes of them.

    pip install mitsuba==3.7.1 numpy        (later ones need a newer LLVM than 15)
    DRJIT_LIBLLVM_PATH=/usr/lib/x86_64-linux-gnu/libLLVM-15.so.1 python tests/data/generate/transport.py [NAME...]

For each scene NAME:
- `NAME.json`, an Umbravox scene, on a volume beside it;
- `NAME.mean.npy`, float32 [row, column, channel]: scattered radiance along the ray through the middle of each pixel;
- `NAME.variance.npy`: variance of that mean, from samples of independent seeds.

What passes the volume unscattered (environment, background) is not in the pictures. Paths are followed to their end: no
Russian roulette. The transfer functions ask for an opacity that is linear in the value, over a unit distance in which no more
than 2e-4 of the light is lost: extinction is then linear in the value to 1e-4 of itself, as it is in Mitsuba.
"""

import gzip
import json
import math
import pathlib
import sys
import time

import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")
import drjit as dr  # noqa: E402, of the variant

OUT = pathlib.Path(__file__).resolve().parent.parent / "transport"
SIZE = 48
# Optical depth of the unit distance in the densest place.
UNIT_DEPTH = 2e-4
# Median of the standard error of the lit pixels at which a picture is done, and the seconds after which it is in any case.
WANTED_ERROR = 0.01
MOST_SECONDS = 210
BATCH = 1 << 20
# Light of the sky: towards the horizon, the zenith, and a broad sun.
HORIZON, ZENITH, SUN = [0.5, 0.45, 0.4], [0.2, 0.35, 0.8], [2.0, 1.6, 1.0]
SUN_DIRECTION = np.array([0.6, -0.48, 0.64])
SUN_SHARPNESS = 4.0
SKY_SIZE = (64, 128)


# --- volumes ---------------------------------------------------------------------------------------------------------


def box():
    return np.full((17, 17, 17), 255, np.uint8), (1.0, 1.0, 1.0)


def cloud():
    """Ellipsoids with a rough edge on 24 x 24 x 18 voxels, empty at the border."""
    size = np.array([24, 24, 18])
    x = np.stack(np.mgrid[: size[0], : size[1], : size[2]], -1) / (size - 1) * 2 - 1
    density = np.zeros(size)
    for center, radii, weight in [
        ((0.0, 0.0, -0.25), (0.8, 0.7, 0.45), 1.0),
        ((-0.3, 0.2, 0.15), (0.45, 0.5, 0.5), 1.1),
        ((0.35, -0.15, 0.2), (0.4, 0.4, 0.55), 1.2),
    ]:
        density += weight * np.maximum(0, 1 - (((x - center) / radii) ** 2).sum(-1))
    rng = np.random.default_rng(7)
    for _ in range(40):
        wave, phase = rng.normal(scale=5.0, size=3), rng.uniform(0, 2 * math.pi)
        density *= 1 + 0.12 * np.sin(x @ wave + phase)
    return quantised(density), (1.0, 1.0, 1.2)


def blobs():
    """Gaussian blobs on an anisotropic grid, empty at the border."""
    size, spacing = np.array([20, 16, 12]), np.array([1.0, 1.25, 1.5])
    x = np.stack(np.mgrid[: size[0], : size[1], : size[2]], -1) * spacing
    density = np.zeros(size)
    rng = np.random.default_rng(3)
    for _ in range(7):
        center = (0.2 + 0.6 * rng.random(3)) * (size - 1) * spacing
        density += np.exp(-((x - center) ** 2).sum(-1) / (2 * rng.uniform(1.8, 3.0) ** 2))
    return quantised(density), tuple(spacing)


def quantised(density):
    voxels = np.round(np.clip(density / density.max(), 0, 1) * 255).astype(np.uint8)
    inside = np.zeros_like(voxels)
    inside[1:-1, 1:-1, 1:-1] = voxels[1:-1, 1:-1, 1:-1]
    return inside


VOLUMES = {"box": box, "cloud": cloud, "blobs": blobs}


def write_nrrd(path, voxels, spacing):
    directions = " ".join(f"({s},0,0) (0,{t},0) (0,0,{u})" for s, t, u in [spacing])
    header = (
        "NRRD0005\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\n"
        f"sizes: {' '.join(map(str, voxels.shape))}\nspace directions: {directions}\n"
        'space origin: (0,0,0)\nkinds: domain domain domain\nspace units: "mm" "mm" "mm"\nencoding: gzip\n\n'
    )
    data = gzip.compress(np.transpose(voxels).tobytes(), 9, mtime=0)
    path.write_bytes(header.encode() + data)


# --- scenes ----------------------------------------------------------------------------------------------------------


def scene(volume, extinction, *, single=False, factors=(1, 1, 1), albedo=(1, 1, 1), albedo_ends=None, **lighting):
    """`extinction` per mm at the value 255; `albedo_ends` at 0 and 255."""
    voxels, spacing = VOLUMES[volume]()
    center = 0.5 * (np.array(voxels.shape) - 1) * spacing
    unit = UNIT_DEPTH / extinction
    low, high = albedo_ends or ((1, 1, 1), (1, 1, 1))
    points = [
        {"value": 0, "color": list(low), "opacity": 0},
        {"value": 255, "color": list(high), "opacity": -math.expm1(-UNIT_DEPTH)},
    ]
    model = "shadowed_scattering" if single else "multiple_scattering"
    lighting = {"model": model, "extinction": list(factors), "albedo": list(albedo), **lighting}
    if single:
        lighting["shadows"] = {"method": "rays"}
    else:
        lighting["scattering"] = {"method": "monte_carlo", "max_scatterings": 1 << 20}
    eye = center + 40 * np.array([0.48, -0.8, 0.36])
    return {
        "volume": {"path": f"{volume}.nrrd"},
        "camera": {
            "type": "perspective",
            "eye": eye.round(6).tolist(),
            "target": center.tolist(),
            "up": [0, 0, 1],
            "fov_y": 40,
        },
        "image": {"size": [SIZE, SIZE], "color_management": "none"},
        "transfer_function": {"unit_distance": unit, "points": points},
        "march": {"step": 0.25, "early_termination": 1},
        "lighting": lighting,
    }


def henyey_greenstein(g):
    return {"type": "henyey_greenstein", "g": g}


def directional(direction, irradiance):
    return {"type": "directional", "direction": direction, "irradiance": irradiance}


def point(position, intensity):
    return {"type": "point", "position": position, "intensity": intensity}


SPOT = {
    "type": "spot",
    "position": [9, -18, 22],
    "direction": [0, 0.74, -0.67],
    "intensity": [2500, 2200, 2000],
    "beam_angle": 8,
    "cutoff_angle": 20,
}


def scenes():
    return {
        # Homogeneous boxes of 16 mm.
        "box_directional_single": scene(
            "box", 2 / 16, single=True, albedo=(0.9, 0.6, 0.3), lights=[directional([0.3, -0.5, 0.8], [3, 3, 3])]
        ),
        "box_point_single_forward": scene(
            "box", 4 / 16, single=True, albedo=(0.8,) * 3, phase=henyey_greenstein(0.85),
            lights=[point([2, 26, 6], [900, 800, 600])],
        ),
        "box_thin_backward": scene(
            "box", 0.5 / 16, albedo=(0.3, 0.5, 0.7), phase=henyey_greenstein(-0.4),
            lights=[directional([0.3, -0.8, 0.5], [3, 3, 3])],
        ),
        "box_thick_constant": scene(
            "box", 30 / 16, albedo=(0.999, 0.98, 0.9), environment={"radiance": [1, 1, 1], "visible": False}
        ),
        "box_forward": scene(
            "box", 10 / 16, albedo=(0.99,) * 3, phase=henyey_greenstein(0.85),
            lights=[directional([-0.5, 0.7, 0.5], [4, 3, 2])],
        ),
        # Grids.
        "cloud_rayleigh_single": scene(
            "cloud", 0.4, single=True, albedo=(0.7, 0.8, 0.95), phase={"type": "rayleigh"},
            lights=[directional([0.2, -0.3, 0.9], [1.5, 1.5, 1.5]), {**SPOT, "position": [12, -16, 22]}],
        ),
        "cloud_lambert_single": scene(
            "cloud", 1.0, single=True, albedo=(0.9, 0.9, 0.8), phase={"type": "lambert_sphere"},
            lights=[directional([0.8, -0.5, 0.3], [3, 3, 3])],
        ),
        "cloud_sun": scene(
            "cloud", 1.2, albedo=(0.999,) * 3, phase=henyey_greenstein(0.7),
            lights=[directional([-0.6, 0.1, 0.8], [3, 2.8, 2.5])],
        ),
        "cloud_chromatic": scene(
            "cloud", 1.0, factors=(1.0, 0.6, 0.3), albedo=(0.9, 0.95, 0.99),
            phase={"type": "double_henyey_greenstein", "g1": 0.7, "g2": -0.4, "weight": 0.65},
            lights=[point([30, -6, 30], [700, 700, 700])], environment={"radiance": [0.2, 0.3, 0.4], "visible": False},
        ),
        "blobs_sky": scene(
            "blobs", 0.6, albedo=(0.95, 0.9, 0.8), phase=henyey_greenstein(0.3),
            environment={"path": "sky.exr", "visible": False},
        ),
        "blobs_spot": scene(
            "blobs", 0.8, albedo_ends=((0.95, 0.5, 0.3), (0.6, 0.9, 0.95)), phase=henyey_greenstein(-0.3), lights=[SPOT]
        ),
    }


# --- the sky ---------------------------------------------------------------------------------------------------------


def sky(direction):
    """Radiance from a direction, [..., 3]."""
    height = (0.5 + 0.5 * direction[..., 2:]) ** 2
    sun = np.exp(SUN_SHARPNESS * (direction @ SUN_DIRECTION - 1))[..., None]
    return np.array(HORIZON) + (np.array(ZENITH) - HORIZON) * height + np.array(SUN) * sun


def equirectangular(rows, columns):
    """Directions of the middles of pixels: +x in the middle column, +z at the upper edge, clockwise seen from there."""
    polar = (np.arange(rows)[:, None] + 0.5) / rows * math.pi
    azimuth = (0.5 - (np.arange(columns)[None] + 0.5) / columns) * 2 * math.pi
    sin = np.sin(polar)
    return np.stack([sin * np.cos(azimuth), sin * np.sin(azimuth), np.cos(polar) + 0 * azimuth], -1)


def write_sky(path):
    image = sky(equirectangular(*SKY_SIZE)).astype(np.float16)
    mi.Bitmap(image.astype(np.float32)).convert(component_format=mi.Struct.Type.Float16).write(str(path))


def sky_emitter():
    # Finer than the file: Mitsuba places its texels by another rule, which no longer matters at this size.
    image = sky(equirectangular(1024, 2048)).astype(np.float32)
    # Its middle column lies towards local +z, its upper edge towards local +y.
    turn = mi.ScalarTransform4f().rotate([0, 0, 1], 90) @ mi.ScalarTransform4f().rotate([1, 0, 0], 90)
    emitter = {"type": "envmap", "bitmap": mi.Bitmap(image), "to_world": turn}
    check = mi.load_dict(emitter)
    rng = np.random.default_rng(1)
    towards = rng.normal(size=(1000, 3))
    towards /= np.linalg.norm(towards, axis=1, keepdims=True)
    si = dr.zeros(mi.SurfaceInteraction3f, 1000)
    si.wi = mi.Vector3f(-towards.T.astype(np.float32))
    seen = np.array(check.eval(si)).T
    error = np.abs(seen / sky(towards) - 1).max()
    assert error < 0.01, f"the sky is turned: {error}"
    return emitter


# --- Mitsuba ---------------------------------------------------------------------------------------------------------


def phase_function(phase):
    match phase["type"]:
        case "isotropic":
            return {"type": "isotropic"}
        case "henyey_greenstein":
            return {"type": "hg", "g": phase["g"]}
        case "double_henyey_greenstein":
            # Not `blendphase`: of 3.7.1 it samples one lobe and returns the density of that one alone, so that what is weighted
            # by densities (here: light from all around) comes out some percent too bright.
            cos = np.linspace(-1, 1, 4001)
            lobe = {g: (1 - g * g) / (1 + g * g - 2 * g * cos) ** 1.5 for g in [phase["g1"], phase["g2"]]}
            return table(phase["weight"] * lobe[phase["g1"]] + (1 - phase["weight"]) * lobe[phase["g2"]])
        case "rayleigh":
            return {"type": "rayleigh"}
        case "lambert_sphere":
            angle = np.arccos(-np.linspace(-1, 1, 1001))
            return table(np.sin(angle) + (math.pi - angle) * np.cos(angle))


def table(values):
    """Of values at equal steps of the cosine from -1 to 1."""
    return {"type": "tabphase", "values": ",".join(f"{max(v, 1e-9):.9g}" for v in values)}


def rgb(values):
    return {"type": "rgb", "value": [float(v) for v in values]}


def emitter(light):
    at = light.get("position")
    match light["type"]:
        case "directional":
            travel = [-x for x in light["direction"]]
            return {"type": "directional", "direction": travel, "irradiance": rgb(light["irradiance"])}
        case "point":
            return {"type": "point", "position": at, "intensity": rgb(light["intensity"])}
        case "spot":
            target = [a + b for a, b in zip(at, light["direction"])]
            return {
                "type": "spot",
                "to_world": mi.ScalarTransform4f().look_at(origin=at, target=target, up=[1, 0, 0]),
                "intensity": rgb(light["intensity"]),
                "beam_width": light["beam_angle"],
                "cutoff_angle": light["cutoff_angle"],
            }


def grid(values, spacing):
    """A `gridvolume` of [x, y, z, channel] with its texels at the voxels: they are middles of cells."""
    data = np.ascontiguousarray(np.transpose(values, (2, 1, 0, 3)).astype(np.float32))
    extent = np.array(values.shape[:3]) * spacing
    place = mi.ScalarTransform4f().translate((-0.5 * np.array(spacing)).tolist()).scale(extent.tolist())
    return {"type": "gridvolume", "grid": mi.VolumeGrid(data), "to_world": place, "raw": True, "filter_type": "trilinear"}


def medium(description, voxels, spacing):
    lighting = description["lighting"]
    curve = description["transfer_function"]
    [empty, full] = curve["points"]
    extinction = -math.log1p(-full["opacity"]) / curve["unit_distance"] * np.array(lighting["extinction"])
    value = voxels[..., None] / 255.0
    color = empty["color"] + (np.array(full["color"]) - empty["color"]) * value
    albedo = color * lighting["albedo"]
    phase = phase_function(lighting.get("phase", {"type": "isotropic"}))
    if (voxels == 255).all():
        # Of colours Mitsuba wants numbers up to 1.
        sigma_t = {"sigma_t": rgb(extinction / extinction.max()), "scale": float(extinction.max())}
        return {"type": "homogeneous", **sigma_t, "albedo": rgb(albedo[0, 0, 0]), "phase": phase}
    return {
        "type": "heterogeneous",
        "sigma_t": grid(value * extinction[:1], spacing),
        "albedo": grid(albedo, spacing),
        "phase": phase,
    }


def mitsuba_scene(description, voxels, spacing):
    lighting = description["lighting"]
    extent = (np.array(voxels.shape) - 1) * spacing
    place = mi.ScalarTransform4f().scale(extent.tolist()) @ mi.ScalarTransform4f().scale(0.5).translate([1, 1, 1])
    parts = {
        "type": "scene",
        "volume": {
            "type": "cube",
            "to_world": place,
            "bsdf": {"type": "null"},
            "interior": medium(description, voxels, spacing),
        },
    }
    for i, light in enumerate(lighting.get("lights", [])):
        parts[f"light_{i}"] = emitter(light)
    environment = lighting.get("environment")
    if environment:
        constant = environment.get("radiance")
        parts["environment"] = {"type": "constant", "radiance": rgb(constant)} if constant else sky_emitter()
    return mi.load_dict(parts)


def rays(camera):
    """Through the middles of the pixels, row by row from the top."""
    eye, target, up = (np.array(camera[key], float) for key in ["eye", "target", "up"])
    forward = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(forward, up)
    right /= np.linalg.norm(right)
    upward = np.cross(right, forward)
    row, column = np.mgrid[:SIZE, :SIZE] + 0.5
    tangent = math.tan(math.radians(camera["fov_y"]) / 2)
    x, y = (2 * column - SIZE) / SIZE * tangent, (1 - 2 * row / SIZE) * tangent
    direction = forward + right * x[..., None] + upward * y[..., None]
    direction /= np.linalg.norm(direction, axis=-1, keepdims=True)
    return eye, direction.reshape(-1, 3)


def render(description, voxels, spacing):
    """Mean and variance of the mean of every pixel, and what it took.

    Where the channels' extinctions differ, each is a picture of a grey medium of its own: the plainest estimator there is.
    """
    extinction = description["lighting"]["extinction"]
    if len(set(extinction)) == 1:
        return render_grey(description, voxels, spacing)
    means, variances, notes = [], [], []
    for channel, factor in enumerate(extinction):
        lighting = {**description["lighting"], "extinction": [factor] * 3}
        mean, variance, note = render_grey({**description, "lighting": lighting}, voxels, spacing)
        means.append(mean[..., channel])
        variances.append(variance[..., channel])
        notes.append(note)
    return np.stack(means, -1), np.stack(variances, -1), "; ".join(notes)


def render_grey(description, voxels, spacing):
    single = description["lighting"]["model"] == "shadowed_scattering"
    integrator = mi.load_dict(
        {
            "type": "volpath",
            "max_depth": 2 if single else -1,
            "rr_depth": 1 << 20,
            "hide_emitters": True,
        }
    )
    world = mitsuba_scene(description, voxels, spacing)
    eye, directions = rays(description["camera"])
    pixels = len(directions)
    share = BATCH // pixels
    first = mi.Vector3f(directions.T.astype(np.float32))
    sums, squares, count = np.zeros((pixels, 3)), np.zeros((pixels, 3)), 0
    began = time.time()
    for seed in range(1 << 16):
        sampler = mi.load_dict({"type": "independent"})
        sampler.seed(seed, pixels * share)
        index = dr.arange(mi.UInt32, pixels * share) // share
        ray = mi.RayDifferential3f(mi.Ray3f(mi.Point3f(*eye.tolist()), dr.gather(mi.Vector3f, first, index)))
        radiance = integrator.sample(world, sampler, ray, None, True)[0]
        samples = np.array(radiance, np.float64).reshape(3, pixels, share)
        sums += samples.sum(-1).T
        squares += (samples**2).sum(-1).T
        count += share
        mean = sums / count
        variance = np.maximum(squares / count - mean**2, 0) / (count - 1)
        lit = mean > 0.05 * mean.max()
        error = np.median(np.sqrt(variance[lit]) / mean[lit])
        seconds = time.time() - began
        if error < WANTED_ERROR or seconds > MOST_SECONDS:
            break
    shape = (SIZE, SIZE, 3)
    return mean.reshape(shape), variance.reshape(shape), f"{count} samples, error {error:.2%}, {seconds:.0f} s"


def main():
    OUT.mkdir(exist_ok=True)
    for name, make in VOLUMES.items():
        write_nrrd(OUT / f"{name}.nrrd", *make())
    write_sky(OUT / "sky.exr")
    for name, description in scenes().items():
        if sys.argv[1:] and name not in sys.argv[1:]:
            continue
        (OUT / f"{name}.json").write_text(json.dumps(description, indent=1) + "\n")
        volume = pathlib.Path(description["volume"]["path"]).stem
        mean, variance, note = render(description, *VOLUMES[volume]())
        np.save(OUT / f"{name}.mean.npy", mean.astype(np.float32))
        np.save(OUT / f"{name}.variance.npy", variance.astype(np.float32))
        print(f"{name}: {note}; mean {mean.mean((0, 1))}, largest {mean.max():.3g}", flush=True)


main()
