"""Pictures of maps and people, from the side, by matplotlib (`pip install ahqp[pictures]`)."""

import numpy as np

BODY = (
    ("ankle", "knee", "hip", "lumbar", "neck", "eyes"),
    ("other_shoulder", "neck", "shoulder"),
    ("shoulder", "elbow", "wrist", "hand"),
)
# The scale of the score e_s.
WORST = 4.25


def draw_map(ergonomics_map, axes=None, *, y=None, resolution=0.01):
    """Draws the score e_s in the vertical plane at y [m], seen from the person's right.

    Parameters
    ----------
    ergonomics_map : ErgonomicsMap
    axes : matplotlib.axes.Axes, optional
        Where to draw; those of a new figure if not given.
    y : float, optional
        Of the person's frame, positive to the left; 0.2 m out on the working hand's side if not given.
    resolution : float
        Size of a pixel [m].

    Returns
    -------
    matplotlib.axes.Axes
    """
    if not resolution > 0.0:
        raise ValueError(f"resolution is {resolution} m; it must be positive")
    if y is None:
        y = 0.2 if ergonomics_map.side == "left" else -0.2
    positions, _ = ergonomics_map.nodes()
    if len(positions) == 0:
        raise ValueError("the map has no node that the hand can reach")
    (left, _, low), (right, _, high) = positions.min(axis=0), positions.max(axis=0)
    x, z = np.arange(left, right, resolution), np.arange(low, high, resolution)
    grid_x, grid_z = np.meshgrid(x, z)
    hands = np.column_stack([grid_x.ravel(), np.full(grid_x.size, y), grid_z.ravel()])
    scores = ergonomics_map.scores(hands).reshape(grid_x.shape)
    axes = _new_axes(axes)
    extent = (left, right, low, high)
    picture = axes.imshow(
        scores, origin="lower", extent=extent, vmin=0.0, vmax=WORST, cmap="RdYlGn_r", alpha=0.8
    )
    axes.figure.colorbar(picture, ax=axes, label="score $e_s$ (0 good)")
    return axes


def draw_person(person, hand, axes=None, *, side="right"):
    """Draws the posture that a person takes to put a hand at a point, (3,), seen from their right.

    Parameters
    ----------
    person : Person
    hand : array_like, shape (3,)
        In the person's frame [m].
    axes : matplotlib.axes.Axes, optional
        Where to draw; those of a new figure if not given.
    side : str
        The working hand, "left" or "right".

    Returns
    -------
    matplotlib.axes.Axes
    """
    landmarks = person.landmarks_at(hand, side=side)
    axes = _new_axes(axes)
    for chain in BODY:
        points = np.array([landmarks[name] for name in chain])
        axes.plot(points[:, 0], points[:, 2], "o-", color="black", markersize=3)
    axes.plot(*landmarks["hand"][[0, 2]], "o", color="tab:blue")
    axes.axhline(0.0, color="grey", linewidth=1)
    return axes


def _new_axes(axes):
    """The axes themselves, or those of a new figure, labelled."""
    if axes is None:
        from matplotlib import pyplot

        axes = pyplot.subplots()[1]
    axes.set_aspect("equal")
    axes.set_xlabel("x, forward [m]")
    axes.set_ylabel("z, up [m]")
    return axes
