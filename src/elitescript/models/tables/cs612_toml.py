"""The content of `cs612.toml`. Written by `python tools/write_reference.py`; do not edit."""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


def document() -> dict[str, Any]:
    """Return the tables of the file, made anew."""
    # fmt: off
    return {'name': 'CS612',
     'type_id': {'value': 6212, 'source': 'sdk', 'why': "number of the model in the vendor's simulator"},
     'payload_max_kg': {'value': 12.0, 'source': 'model-number'},
     'reach_m': {'value': 1.304, 'source': 'datasheet-quoted'},
     'max_tool_speed': {'value': 2.5,
                        'source': 'chosen',
                        'why': 'the base joint at its limit moves the stretched arm with 2.8 m/s'},
     'arm': {'d1': {'value': 0.193, 'source': 'ros-kinematics'},
             'a2': {'value': -0.615, 'source': 'ros-kinematics'},
             'a3': {'value': -0.571, 'source': 'ros-kinematics'},
             'd4': {'value': 0.1775, 'source': 'ros-kinematics'},
             'd5': {'value': 0.118, 'source': 'ros-kinematics'},
             'd6': {'value': 0.1103, 'source': 'ros-kinematics'}},
     'outline': {'base': {'value': [0.095], 'source': 'ros-outline'},
                 'shoulder': {'value': [0.077, -0.092, 0.092, -0.089], 'source': 'ros-outline'},
                 'upperarm_housing': {'value': [0.078, 0.272], 'source': 'ros-outline'},
                 'upperarm_tube': {'value': [0.076, 0.059, 0.181], 'source': 'ros-outline'},
                 'elbow_housing': {'value': [0.061, 0.258], 'source': 'ros-outline'},
                 'forearm_housing': {'value': [0.059, -0.02, 0.11], 'source': 'ros-outline'},
                 'forearm_tube': {'value': [0.059, 0.0435, 0.039], 'source': 'ros-outline'},
                 'forearm_end': {'value': [0.045, -0.022, 0.107], 'source': 'ros-outline'},
                 'wrist_1': {'value': [0.0435, -0.067, 0.062], 'source': 'ros-outline'},
                 'wrist_2': {'value': [0.0435, -0.062, 0.067], 'source': 'ros-outline'},
                 'wrist_3': {'value': [0.043, -0.05, 0.043], 'source': 'ros-outline'}},
     'joints': {'qd_max': {'deg': [120, 120, 180, 180, 180, 180], 'source': 'ros-limits'},
                'effort_max': {'value': [330.0, 330.0, 150.0, 56.0, 56.0, 56.0], 'source': 'ros-limits'},
                'torque_constant': {'value': [17.0, 17.0, 12.5, 10.0, 10.0, 10.0],
                                    'source': 'chosen',
                                    'why': 'N m/A at the joint, gear included; the rated torque then takes 1.5 to 30 '
                                           'A'}},
     'links': {'shoulder': {'mass': {'value': 6.83, 'source': 'ros-masses'},
                            'com': {'value': [9.3e-05, -0.02697, -0.02115], 'source': 'ros-masses'},
                            'inertia': {'value': [0.031204775778, 0.022022728252, 0.03253092938, 1.1256926e-05,
                                                  -5.2723269e-05, 0.004184187865],
                                        'source': 'ros-inertia'}},
               'upperarm': {'mass': {'value': 13.037, 'source': 'ros-masses'},
                            'com': {'value': [-0.2304, -3.9e-05, 0.16068], 'source': 'ros-masses'},
                            'inertia': {'value': [0.036809900662, 0.990051726571, 0.988941786251, 0.000176995267,
                                                  0.018761499136, 5.1173379e-05],
                                        'source': 'ros-inertia'}},
               'forearm': {'mass': {'value': 4.827, 'source': 'ros-masses'},
                           'com': {'value': [-0.2998, 1.3e-05, 0.06176], 'source': 'ros-masses'},
                           'inertia': {'value': [0.011694384669, 0.311777432405, 0.308249046104, -6.31275e-06,
                                                 -0.012821032896, 2.549502e-06],
                                       'source': 'ros-inertia'}},
               'wrist_1': {'mass': {'value': 2.315, 'source': 'ros-masses'},
                           'com': {'value': [1e-05, -0.0148, -0.01682], 'source': 'ros-masses'},
                           'inertia': {'value': [0.004927080194, 0.004315357563, 0.002799622168, -1.56162e-06,
                                                 3.677617e-06, 0.00058903384],
                                       'source': 'ros-inertia'}},
               'wrist_2': {'mass': {'value': 2.195, 'source': 'ros-masses'},
                           'com': {'value': [-1.3e-05, 0.015559, -0.011803], 'source': 'ros-masses'},
                           'inertia': {'value': [0.003800886728, 0.003201549403, 0.002598296583, -1.754976e-06,
                                                 -3.492201e-06, -0.000417279115],
                                       'source': 'ros-inertia'}},
               'wrist_3': {'mass': {'value': 0.616, 'source': 'ros-masses'},
                           'com': {'value': [-0.001704, -0.000705, -0.039231], 'source': 'ros-masses'},
                           'inertia': {'value': [0.000745825874, 0.000762443414, 0.000568005205, 6.13013e-07,
                                                 2.1397368e-05, 9.337239e-06],
                                       'source': 'ros-inertia'}}}}
