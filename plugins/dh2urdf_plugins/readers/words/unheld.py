"""Headers that are no field: what they mean, what they look like, and how a column is left out on purpose."""

from __future__ import annotations

from typing import NamedTuple

from dh2urdf.row_fields import ROW_FIELDS
from dh2urdf_plugins.readers.words.word_keys import key_of, keys_of


def _words(text: str) -> tuple[str, ...]:
    return tuple(text.split(", "))


GEOMETRY = "0 in this column, or a table of a, alpha, d and theta (or offset) without it"


class Unheld(NamedTuple):
    """What a header means that no field holds.

    Attributes:
        reason: what it is.
        accepted: what to write in its place.
        counts: whether it may hold the number of the row.
        suggestion: what to do where it is a field under another name.
        zero: whether 0 says nothing.
    """

    reason: str
    accepted: str = GEOMETRY
    counts: bool = False
    suggestion: str | None = None
    zero: bool = True


MOVES_BY_ITSELF = Unheld(
    "whether a joint moves by itself", "a column type: fixed where nothing moves; no joint follows another"
)
_CALL_IT_SO = "if it is one of them, call it so: theta or offset"
WHETHER_ACTIVE = frozenset(
    "active actuated actuator motor drive enabled motorized motorised driven movable moving moves canmove mobile free "  # noqa: SIM905
    "used independent dof dofs ndof degreesoffreedom degreeoffreedom beweglich aktiv angetrieben antrieb actif "
    "activo attivo ativo freiheitsgrad freiheitsgrade".split()
)
"""Headers of what a joint has that moves by itself, by their keys: refused where a cell is a no."""
NO = frozenset("0 false no n off none ✗ ✘ ❌ falsch nein non faux falso".split())  # noqa: SIM905
_HOME = Unheld("an angle or a length that may be theta, d or an offset", suggestion=_CALL_IT_SO)
_RIGID = "a table without it: joints do not yield"
_AT_THE_JOINT = "damping and friction as the joint feels them, behind the gear"
UNHELD_WORDS = {
    "mu": Unheld("whether a joint is driven, in Khalil and Kleinfinger's convention"),
    "q": Unheld("the joint variable"),
    "q offset": Unheld("an offset of the joint variable"),
    "q0": _HOME,
    **dict.fromkeys(_words("phi, phi0"), Unheld("an angle that may be theta or an offset", suggestion=_CALL_IT_SO)),
    **dict.fromkeys(
        _words(
            "fixed, locked, mimic, mimics, follows, coupling, coupled, coupled with, depends on, driven by, passive, "
            "unactuated, inactive, disabled, virtual, dummy"
        ),
        MOVES_BY_ITSELF,
    ),
    "angle": Unheld("an angle that may be theta, alpha or an offset", suggestion=_CALL_IT_SO),
    **dict.fromkeys(
        _words(
            "home, theta home, home theta, home position, home angle, theta0, theta zero, d0, theta init, zero, "
            "zero offset, zero position, encoder offset, initial, initial value, initial angle, initial position, "
            "theta initial, initial theta, start, start angle, start position, rest position, value"
        ),
        _HOME,
    ),
    "d offset": Unheld("an offset of d alone"),
    **dict.fromkeys(
        _words("d min, d max"),
        Unheld("a bound of d itself", "columns lower and upper, which bound q: d without its offset"),
    ),
    "mdh": Unheld("the convention as a number"),
    "prismatic": Unheld("the type of a joint in another form"),
    "revolute": Unheld("the type of a joint in another form", "a column type: revolute, prismatic", zero=False),
    **dict.fromkeys(
        _words("x, y, z, xyz, dx, dy, dz, tx, ty, tz, px, py, pz"),
        Unheld(
            "a coordinate that may be of a frame or of a centre of mass", "com_x, com_y, com_z for a centre of mass"
        ),
    ),
    **dict.fromkeys(_words("roll, pitch, yaw, rpy, rx, ry, rz"), Unheld("a turn of a frame beside the DH parameters")),
    **dict.fromkeys(
        _words("rotor inertia, motor inertia, motor rotor inertia, inertia of rotor, rotorträgheit, motorträgheit"),
        Unheld(
            "the inertia of a rotor, before or behind its gear",
            "a column armature: the inertia that the joint feels, the rotor's times the square of the gear ratio",
        ),
    ),
    **dict.fromkeys(
        _words(
            "gear ratio, ratio, gear, g, reduction, reduction ratio, transmission ratio, übersetzung, "
            "rapport de réduction, relación de transmisión, rapporto di riduzione, relação de transmissão, "
            "relação de redução, 减速比, 传动比"
        ),
        Unheld("the ratio of a gear", f"a column armature with the rotor's inertia behind the gear; {_AT_THE_JOINT}"),
    ),
    **dict.fromkeys(
        _words(
            "stiffness, joint stiffness, spring stiffness, spring constant, spring rate, spring, elasticity, "
            "compliance, steifigkeit, gelenksteifigkeit, federkonstante, raideur, raideur articulaire, rigidez, "
            "rigidezza, 刚度"
        ),
        Unheld("how far the joint yields under a load", _RIGID),
    ),
    **dict.fromkeys(
        _words(
            "backlash, gear backlash, joint backlash, lost motion, spiel, getriebespiel, jeu, juego, gioco, folga, 间隙"
        ),
        Unheld("the play of a gear", _RIGID),
    ),
    **dict.fromkeys(_words("tc, tc+, tc-, fs, fv"), Unheld("a friction of the motor or of the joint", _AT_THE_JOINT)),
    **dict.fromkeys(
        _words("xx, xy, xz, yy, yz, zz, mx, my, mz, ia, lxx, lyy, lzz, ix, iy, iz, jx, jy, jz"),
        Unheld(
            "a dynamic parameter that may be about the frame's origin",
            "ixx … iyz about the centre of mass, com_x, com_y, com_z and mass",
        ),
    ),
    **dict.fromkeys(
        _words("lc, rc, lcx, lcy, lcz, rcx, rcy, rcz, pcx, pcy, pcz"),
        Unheld("the distance of a centre of mass", "com_x, com_y, com_z in the frame after the row"),
    ),
    **dict.fromkeys(
        _words(
            "rated torque, nominal torque, continuous torque, holding torque, stall torque, nennmoment, "
            "torque nominal, 额定力矩, 额定扭矩, 额定转矩"
        ),
        Unheld("a torque that may not be the largest", "a column effort: the largest torque or force of the joint"),
    ),
    **dict.fromkeys(
        _words("rated speed, nominal speed, nenndrehzahl, velocidade nominal, 额定速度, 额定转速"),
        Unheld("a speed that may not be the largest", "a column velocity: the largest speed of the joint"),
    ),
    **dict.fromkeys(
        _words("qd, dq, q dot, dot q, theta dot"), Unheld("a speed that may not be a limit", "velocity, or qd_max")
    ),
    **dict.fromkeys(
        _words("qdd, ddq, qdd max, ddq max, q ddot max"), Unheld("a limit of acceleration", "a table without it")
    ),
    "j": Unheld("the number of a row, or an inertia", "a column index, or ixx … iyz", counts=True),
    **dict.fromkeys(
        _words("n, k"), Unheld("the symbol of a quantity, or the number of a row", "a column index", counts=True)
    ),
    **dict.fromkeys(
        _words("unit, units, einheit, einheiten, unité, unités, unidad, unidades, unità, unidade, 单位"),
        Unheld("the unit of a row", "units in the headers, such as `a [mm]`, in the cells, or above the header"),
    ),
    "diameter": Unheld("twice a radius", "a column radius"),
    "density": Unheld("a density", "`defaults: {density: 2700}` for all links, or a column mass"),
    "payload": Unheld("a load at the tool", "`payload: {mass: 5}` for the whole arm"),
}
"""Headers of what shapes or loads the arm and no field holds: refused where a cell is not 0."""
_HELD = {key for name in ROW_FIELDS for key in keys_of(name)}
THETA_OFFSETS = {
    key: Unheld(
        "an offset of theta alone, and the table has a theta besides",
        suggestion="if it is added to the joint variable, call it offset",
    )
    for word in ("theta offset", "offset theta", "theta const", "joint angle offset")
    for key in keys_of(word)
}
"""Headers of the constant part of theta, by their keys: they are theta where nothing else is."""
UNHELD = {key: meaning for word, meaning in UNHELD_WORDS.items() for key in keys_of(word) if key not in _HELD}
"""The same by their keys."""


def meaning_of(key: str) -> Unheld | None:
    """What a header means that no field holds, by its key: ``passive?`` and ``isfixed`` are known, too."""
    asked = key.strip("?")
    return UNHELD.get(asked) or UNHELD.get(asked.removeprefix("is")) or THETA_OFFSETS.get(asked)


def is_still(header: str, text: str) -> bool:
    """Whether a cell says that its joint does not move by itself: ``no`` under ``movable``."""
    asked = key_of(header.casefold()).strip("?")
    return text.casefold() in NO and (asked in WHETHER_ACTIVE or asked.removeprefix("is") in WHETHER_ACTIVE)


# --- Headers that look like fields ------------------------------------------------------------------------------------

SUSPECTS = {
    "acceleration": "accel*, acceler*, aceler*, *beschleunigung*, qdd, ddq, *加速度*",
    "jerk": "jerk, ruck, dddq*, qddd*, dtau*, taud*",
    "inertia": "inertia*, inertial, moi, *trägheit*, inertie*, inercia*, inérc*, inerzia*, *惯*",
    "com": "com, cog, centroid*, gravity, *schwerpunkt*, baricentr*, barycentr*, gravité, gravedad, "
    "gravidade, *质心*, *重心*",
    "velocity": "speed*, veloc*, vel, rpm, *geschwindigkeit*, *drehzahl*, vitesse*, omega, qd, dq, qdot, *速*",
    "effort": "torque*, effort*, force, forces, *moment*, couple*, coppi*, par, fuerza*, forza, kraft*, "
    "tau, stall, força*, *力矩*, *扭矩*, *转矩*",
    "damping": "damp*, *dämpfung*, viscous, viskos*, amortiss*, amortig*, smorz*, amortec*, *阻尼*",
    "friction": "friction*, *reibung*, frottement*, fricción*, attrito, coulomb*, stiction, atrito*, *摩擦*",
    "armature": "rotor, armature",
    "stiffness": "stiff*, spring*, *steif*, complian*, elasti*, raideur*, rigid*, backlash*, *刚度*",
    "gear": "gear*, ratio, *getriebe*, *übersetzung, reducer*, reduction*, redução*, *减速*",
    "mass": "mass, masses, weight*, *masse, masa, massa, peso, poids, *gewicht*, payload*, *质量*, *重量*",
    "offset": "offset*, zero*, home*, *versatz*, décalage*, desfase*, desplazamiento*, *nullpunkt*, "
    "calibration*, deslocamento*, *偏*, *零位*, *初始*",
    "sign": "sign, sense, clockwise, counterclockwise, cw, ccw, "
    "mirror*, direction*, dir, invert*, revers*, flip*, polarity, vorzeichen, "
    "*richtung, *drehsinn, sens, sentido, senso, sinal, *方向*",
    "limits": "limit*, límit*, range, ranges, bound*, stroke, travel, *grenze*, *bereich, anschlag, plage, butée*, "
    "borne*, rango, recorrido, corsa, escursione, débattement, lower, upper, min, max, minimum, maximum, "
    "faixa, curso, *范围*, *限*, *行程*",
    "type": "prismatic, revolute, rotary, rotational, translational, rotates, slides, *类型*, 运动副*",
    "alpha": "alpha, α, twist*, verdreh*, torsion*, torsión*, torção*, *扭*",
    "a": "length*, *länge*, longueur*, longitud*, lunghezza*, comprimento*, *长*",
    "theta": "theta, θ, angle*, *winkel, ángulo*, angolo*, ângulo*, *角, *角度*, 角位*",
    "radius": "radius, radii, diameter*, durchmesser, thickness, raio*, *半径*, *直径*",
}
"""Words in the headers of columns that probably are a field, by field; ``*`` stands for any letters."""
PROSE = (
    "note, notes, comment, comments, remark, remarks, description, source, reference, supplier, vendor, url, "
    "datasheet, "
    "bemerkung, bemerkungen, kommentar, beschreibung, quelle, remarque, remarques, commentaire, nota, notas, "
    "comentario, commento, comentário, observação, fonte, 备注, 注, 说明, 来源"
)
"""Words in the headers of columns that hold text for people."""
LIKELY = {
    key: f"if {word} is the inertia of a rotor, write a column armature: what the joint feels of it, behind the gear"
    for word in ("Jm", "Im", "Jr", "Ir")
    for key in keys_of(word.casefold())
}
"""Messages about headers that are left out and may be something: symbols whose meaning differs from book to book."""
IGNORED = "_"
"""What the header of a column begins with that its author wants to be left out."""
