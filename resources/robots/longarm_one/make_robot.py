#!/usr/bin/env python3
"""Writes longarm_one.urdf and longarm_one.srdf, and the same with two pan-tilt-zoom cameras instead of the
stereo head (longarm_one_ptz.*).  Both robots share all but the head, and URDF has no include.

Run in this folder:  python3 make_meshes.py && python3 make_robot.py
Collision shapes are primitives (fast and exact); the meshes are for the eye.
"""

COLOURS = {
    "graphite": "0.16 0.17 0.19 1",
    "steel": "0.55 0.57 0.60 1",
    "orange": "0.93 0.42 0.08 1",
    "rubber": "0.07 0.07 0.08 1",
    "shell": "0.80 0.81 0.80 1",
    "glass": "0.05 0.08 0.14 1",
    "lamp": "0.95 0.93 0.80 1",
}

HALF_PI = "1.5707963267948966"

# Top of the pedestal, from there to the shoulder's pitch axis, upper arm, forearm, where the forearm rolls [m].
PEDESTAL_TOP, SHOULDER, UPPER, FOREARM, ROLL_AT = 0.33, 0.10, 0.56, 0.50, 0.24
WRIST_TO_FLANGE, FLANGE_TO_TIP = 0.07, 0.15
ARM_X, MAST_X, MAST_TOP = 0.04, -0.26, 0.95


def origin(xyz=(0, 0, 0), rpy=(0, 0, 0)):
    numbers = lambda v: " ".join(x if isinstance(x, str) else f"{x:.10g}" for x in v)
    return f'<origin xyz="{numbers(xyz)}" rpy="{numbers(rpy)}"/>'


def box(x, y, z):
    return f'<box size="{x:g} {y:g} {z:g}"/>'


def cylinder(radius, length):
    return f'<cylinder radius="{radius:g}" length="{length:g}"/>'


def mesh(name):
    return f'<mesh filename="meshes/{name}.stl"/>'


def visual(geometry, colour, xyz=(0, 0, 0), rpy=(0, 0, 0)):
    return (f'    <visual>{origin(xyz, rpy)}<geometry>{geometry}</geometry>'
            f'<material name="{colour}"/></visual>\n')


def collision(geometry, xyz=(0, 0, 0), rpy=(0, 0, 0)):
    return f'    <collision>{origin(xyz, rpy)}<geometry>{geometry}</geometry></collision>\n'


def link(name, *shapes):
    if not shapes:
        return f'  <link name="{name}"/>\n'
    return f'  <link name="{name}">\n{"".join(shapes)}  </link>\n'


def fixed(name, parent, child, xyz=(0, 0, 0), rpy=(0, 0, 0)):
    return (f'  <joint name="{name}" type="fixed"><parent link="{parent}"/><child link="{child}"/>'
            f'{origin(xyz, rpy)}</joint>\n')


def moving(name, kind, parent, child, axis, limits, xyz=(0, 0, 0), rpy=(0, 0, 0), mimic=None):
    lower, upper, velocity, effort = limits
    follows = f'\n    <mimic joint="{mimic}"/>' if mimic else ""
    return (f'  <joint name="{name}" type="{kind}">\n    <parent link="{parent}"/><child link="{child}"/>\n'
            f'    {origin(xyz, rpy)}<axis xyz="{axis}"/>\n'
            f'    <limit lower="{lower:g}" upper="{upper:g}" velocity="{velocity:g}" effort="{effort:g}"/>{follows}\n'
            f'  </joint>\n')


def optical(name, parent, xyz, down=0.0, backwards=False):
    """A camera's optical frame looking along x (or -x) of its parent, tilted down by `down` [rad]."""
    half = float(HALF_PI)
    return link(name) + fixed(name + "_joint", parent, name, xyz,
                              (-(half + down), 0, half if backwards else -half))


def base():
    track = lambda side: (visual(mesh("track"), "rubber", (0, side * 0.2, 0)),
                          visual(mesh("track_wheels"), "steel", (0, side * 0.2, 0)),
                          collision(box(0.72, 0.1, 0.2), (0, side * 0.2, 0.105)))
    return link(
        "base_link",
        visual(mesh("hull"), "graphite"),
        visual(mesh("deck"), "orange"),
        *track(1), *track(-1),
        visual(cylinder(0.085, 0.08), "graphite", (ARM_X, 0, 0.29)),
        visual(mesh("mast"), "steel", (MAST_X, 0, 0)),
        visual(cylinder(0.022, 0.012), "lamp", (0.315, 0.085, 0.2), (0, HALF_PI, 0)),
        visual(cylinder(0.022, 0.012), "lamp", (0.315, -0.085, 0.2), (0, HALF_PI, 0)),
        collision(box(0.62, 0.5, 0.17), (0, 0, 0.165)),
        collision(cylinder(0.085, 0.08), (ARM_X, 0, 0.29)),
        collision(box(0.08, 0.08, MAST_TOP - 0.25), (MAST_X, 0, 0.5 * (MAST_TOP + 0.25))),
        collision(box(0.16, 0.2, 0.1), (MAST_X, 0, 0.3)),
    ) + optical("drive_optical", "base_link", (0.33, 0, 0.2), down=0.12) \
      + optical("reverse_optical", "base_link", (-0.33, 0, 0.22), down=0.25, backwards=True)


def arm():
    rpm = 1.5
    return "".join((
        link("arm_1_link",
             visual(mesh("turret"), "shell"),
             visual(cylinder(0.072, 0.02), "orange", (0, 0, 0.012)),
             collision(cylinder(0.075, 0.07), (0, 0, 0.035)),
             collision(cylinder(0.062, 0.15), (0, 0, SHOULDER), (HALF_PI, 0, 0))),
        moving("arm_1_joint", "revolute", "base_link", "arm_1_link", "0 0 1", (-2.9, 2.9, rpm, 200),
               (ARM_X, 0, PEDESTAL_TOP)),
        link("arm_2_link",
             visual(mesh("upper_arm"), "shell"),
             visual(cylinder(0.064, 0.156), "orange", (0, 0, UPPER), (HALF_PI, 0, 0)),
             collision(cylinder(0.058, UPPER), (0, 0, 0.5 * UPPER)),
             collision(cylinder(0.066, 0.16), (0, 0, UPPER), (HALF_PI, 0, 0))),
        moving("arm_2_joint", "revolute", "arm_1_link", "arm_2_link", "0 1 0", (-1.9, 1.9, rpm, 200),
               (0, 0, SHOULDER)),
        link("arm_3_link",
             visual(mesh("elbow"), "graphite"),
             collision(cylinder(0.052, ROLL_AT), (0, 0, 0.5 * ROLL_AT))),
        moving("arm_3_joint", "revolute", "arm_2_link", "arm_3_link", "0 1 0", (-2.6, 2.6, rpm, 120),
               (0, 0, UPPER)),
        link("arm_4_link",
             visual(mesh("forearm"), "shell"),
             visual(cylinder(0.0465, 0.012), "orange", (0, 0, 0.012)),
             collision(cylinder(0.046, 0.2), (0, 0, 0.1)),
             collision(cylinder(0.045, 0.1), (0, 0, FOREARM - ROLL_AT), (HALF_PI, 0, 0))),
        moving("arm_4_joint", "revolute", "arm_3_link", "arm_4_link", "0 0 1", (-2.9, 2.9, rpm, 60),
               (0, 0, ROLL_AT)),
        link("arm_5_link",
             visual(mesh("wrist"), "graphite"),
             collision(cylinder(0.04, WRIST_TO_FLANGE), (0, 0, 0.5 * WRIST_TO_FLANGE))),
        moving("arm_5_joint", "revolute", "arm_4_link", "arm_5_link", "0 1 0", (-2.1, 2.1, rpm, 60),
               (0, 0, FOREARM - ROLL_AT)),
        link("arm_6_link",
             visual(cylinder(0.042, 0.03), "orange", (0, 0, 0.015)),
             visual(mesh("palm"), "graphite"),
             visual(mesh("camera_pod"), "shell", (0.06, 0, 0.035)),
             visual(cylinder(0.012, 0.006), "glass", (0.06, 0, 0.056)),
             collision(box(0.07, 0.15, 0.06), (0, 0, 0.06)),
             collision(cylinder(0.042, 0.03), (0, 0, 0.015)),
             collision(box(0.04, 0.06, 0.045), (0.06, 0, 0.035))),
        moving("arm_6_joint", "revolute", "arm_5_link", "arm_6_link", "0 0 1", (-2.9, 2.9, rpm, 30),
               (0, 0, WRIST_TO_FLANGE)),
        link("tool_tip"),
        fixed("tool_tip_joint", "arm_6_link", "tool_tip", (0, 0, FLANGE_TO_TIP)),
        link("wrist_optical"),
        fixed("wrist_optical_joint", "arm_6_link", "wrist_optical", (0.06, 0, 0.06), (0, -0.2, 0)),
        finger("left", 1, None),
        finger("right", -1, "gripper_joint"),
    ))


def finger(side, sign, mimic):
    joint = "gripper_joint" if mimic is None else f"gripper_{side}_joint"
    turned = (0, 0, 0) if sign > 0 else (0, 0, "3.141592653589793")
    return link(f"finger_{side}_link",
                visual(mesh("finger"), "steel"),
                visual(box(0.026, 0.004, 0.05), "rubber", (0, 0.002, 0.05)),
                collision(box(0.028, 0.016, 0.078), (0, 0.008, 0.039))) + \
        moving(joint, "prismatic", "arm_6_link", f"finger_{side}_link", "0 1 0", (0, 0.05, 0.1, 40),
               (0, 0, 0.088), turned, mimic)


def torso():
    return link("torso_link",
                visual(cylinder(0.028, 0.51), "shell", (0, 0, -0.045)),
                visual(cylinder(0.05, 0.03), "graphite", (0, 0, 0.195)),
                collision(cylinder(0.03, 0.51), (0, 0, -0.045))) + \
        moving("torso_joint", "prismatic", "base_link", "torso_link", "0 0 1", (0, 0.3, 0.1, 300),
               (MAST_X, 0, MAST_TOP))


def stereo_head():
    return "".join((
        link("head_pan_link",
             visual(cylinder(0.045, 0.04), "orange", (0, 0, 0.02)),
             visual(box(0.05, 0.09, 0.06), "graphite", (0, 0, 0.06)),
             collision(cylinder(0.052, 0.09), (0, 0, 0.045))),
        moving("head_pan_joint", "revolute", "torso_link", "head_pan_link", "0 0 1", (-2.6, 2.6, 1.5, 10),
               (0, 0, 0.21)),
        link("head_tilt_link",
             visual(mesh("head"), "shell"),
             visual(cylinder(0.026, 0.02), "glass", (0.064, 0.127, 0.02), (0, HALF_PI, 0)),
             visual(cylinder(0.026, 0.02), "glass", (0.064, -0.127, 0.02), (0, HALF_PI, 0)),
             collision(box(0.12, 0.36, 0.09), (0.015, 0, 0.02))),
        moving("head_tilt_joint", "revolute", "head_pan_link", "head_tilt_link", "0 1 0", (-0.9, 0.8, 1.5, 10),
               (0, 0, 0.09), (0, 0.6, 0)),
        optical("head_left_optical", "head_tilt_link", (0.06, 0.127, 0.02)),
        optical("head_right_optical", "head_tilt_link", (0.06, -0.127, 0.02)),
    ))


def ptz_heads():
    text = link("crossbar_link",
                visual(box(0.05, 0.5, 0.04), "graphite", (0, 0, 0.02)),
                collision(box(0.06, 0.5, 0.04), (0, 0, 0.02))) + \
        fixed("crossbar_joint", "torso_link", "crossbar_link", (0, 0, 0.21))
    for side, y in (("left", 0.2), ("right", -0.2)):
        text += "".join((
            link(f"ptz_{side}_pan_link",
                 visual(cylinder(0.04, 0.04), "orange", (0, 0, 0.02)),
                 visual(box(0.04, 0.1, 0.05), "graphite", (0, 0, 0.055)),
                 collision(cylinder(0.055, 0.08), (0, 0, 0.04))),
            moving(f"ptz_{side}_pan_joint", "revolute", "crossbar_link", f"ptz_{side}_pan_link", "0 0 1",
                   (-2.9, 2.9, 1.5, 10), (0, y, 0.04)),
            link(f"ptz_{side}_tilt_link",
                 visual(mesh("ptz"), "shell"),
                 visual(cylinder(0.024, 0.02), "glass", (0.074, 0, 0), (0, HALF_PI, 0)),
                 collision(box(0.15, 0.09, 0.09), (0.01, 0, 0))),
            moving(f"ptz_{side}_tilt_joint", "revolute", f"ptz_{side}_pan_link", f"ptz_{side}_tilt_link", "0 1 0",
                   (-0.9, 0.8, 1.5, 10), (0, 0, 0.1), (0, 0.6, 0)),
            optical(f"ptz_{side}_optical", f"ptz_{side}_tilt_link", (0.07, 0, 0)),
        ))
    return text


def robot(name, head):
    materials = "".join(f'  <material name="{n}"><color rgba="{c}"/></material>\n' for n, c in COLOURS.items())
    return ('<?xml version="1.0"?>\n<!-- Written by make_robot.py: change that. -->\n'
            f'<robot name="{name}">\n{materials}{base()}{arm()}{torso()}{head}</robot>\n')


ARM_JOINTS = [f"arm_{i}_joint" for i in range(1, 7)]

POSES = {
    "home": (2.43, 0.56, 2.17, 0.0, 1.35, 0.0),
    "stow": (2.22, 0.79, 2.33, 0.0, 1.77, 0.0),
    "ready": (0.0, -0.2, 1.9, 0.0, 1.44, 0.0),
    "look_ahead": (0.0, -0.15, 2.15, 0.0, -0.43, 0.0),
}

# Bodies that stand still to each other, and neighbours that touch at their joint.
ADJACENT = [("base_link", "arm_1_link"), ("arm_1_link", "arm_2_link"), ("arm_2_link", "arm_3_link"),
            ("arm_3_link", "arm_4_link"), ("arm_4_link", "arm_5_link"), ("arm_5_link", "arm_6_link"),
            ("arm_6_link", "finger_left_link"), ("arm_6_link", "finger_right_link"),
            ("finger_left_link", "finger_right_link"), ("base_link", "torso_link")]
# Pairs that no joint angle brings together.
NEVER = [("arm_5_link", "finger_left_link"), ("arm_5_link", "finger_right_link"), ("arm_1_link", "torso_link")]
STEREO = [("torso_link", "head_pan_link"), ("head_pan_link", "head_tilt_link"), ("torso_link", "head_tilt_link"),
          ("base_link", "head_pan_link"), ("base_link", "head_tilt_link"),
          ("arm_1_link", "head_pan_link"), ("arm_1_link", "head_tilt_link")]


def ptz_pairs():
    pairs = [("torso_link", "crossbar_link"), ("base_link", "crossbar_link"), ("arm_1_link", "crossbar_link"),
             ("ptz_left_pan_link", "ptz_right_pan_link")]
    for side in ("left", "right"):
        pan, tilt, other = f"ptz_{side}_pan_link", f"ptz_{side}_tilt_link", "right" if side == "left" else "left"
        pairs += [("crossbar_link", pan), ("crossbar_link", tilt), (pan, tilt), ("torso_link", pan),
                  ("torso_link", tilt), ("base_link", pan), ("base_link", tilt), ("arm_1_link", pan),
                  ("arm_1_link", tilt), (tilt, f"ptz_{other}_pan_link")]
    return pairs + [("ptz_left_tilt_link", "ptz_right_tilt_link")]


def srdf(name, head_pairs, heads):
    text = ('<?xml version="1.0"?>\n<!-- Written by make_robot.py: change that. -->\n'
            f'<robot name="{name}">\n'
            '  <group name="arm"><chain base_link="base_link" tip_link="tool_tip"/></group>\n'
            '  <group name="gripper"><joint name="gripper_joint"/></group>\n')
    for group, joints in heads.items():
        text += f'  <group name="{group}">' + "".join(f'<joint name="{j}"/>' for j in joints) + "</group>\n"
    for pose, values in POSES.items():
        joints = "".join(f'\n    <joint name="{j}" value="{v:g}"/>' for j, v in zip(ARM_JOINTS, values))
        text += f'  <group_state name="{pose}" group="arm">{joints}\n  </group_state>\n'
    for reason, pairs in (("Adjacent", ADJACENT), ("Never", NEVER + head_pairs)):
        for a, b in pairs:
            text += f'  <disable_collisions link1="{a}" link2="{b}" reason="{reason}"/>\n'
    return text + "</robot>\n"


def write(path, text):
    with open(path, "w", encoding="ascii", newline="\n") as file:
        file.write(text)


def main():
    write("longarm_one.urdf", robot("longarm_one", stereo_head()))
    write("longarm_one.srdf", srdf("longarm_one", STEREO, {"head": ["head_pan_joint", "head_tilt_joint"]}))
    write("longarm_one_ptz.urdf", robot("longarm_one_ptz", ptz_heads()))
    write("longarm_one_ptz.srdf", srdf("longarm_one_ptz", ptz_pairs(), {
        f"ptz_{s}": [f"ptz_{s}_pan_joint", f"ptz_{s}_tilt_joint"] for s in ("left", "right")}))


if __name__ == "__main__":
    main()
