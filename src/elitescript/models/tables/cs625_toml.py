"""The content of `cs625.toml`. Written by `python tools/write_reference.py`; do not edit."""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


def document() -> dict[str, Any]:
    """Return the tables of the file, made anew."""
    # fmt: off
    return {'name': 'CS625',
     'type_id': {'value': 6225, 'source': 'sdk', 'why': "number of the model in the vendor's simulator"},
     'payload_max_kg': {'value': 25.0, 'source': 'model-number'},
     'reach_m': {'value': 1.5, 'source': 'reach-formula'},
     'max_tool_speed': {'value': 2.5,
                        'source': 'chosen',
                        'why': 'the base joint at its limit moves the stretched arm with 3.2 m/s'},
     'arm': {'d1': {'value': 0.235, 'source': 'ros-kinematics'},
             'a2': {'value': -0.75, 'source': 'ros-kinematics'},
             'a3': {'value': -0.622, 'source': 'ros-kinematics'},
             'd4': {'value': 0.1725, 'source': 'ros-kinematics'},
             'd5': {'value': 0.128, 'source': 'ros-kinematics'},
             'd6': {'value': 0.125, 'source': 'ros-kinematics'}},
     'outline': {'base': {'value': [0.12], 'source': 'ros-outline'},
                 'shoulder': {'value': [0.093, -0.118, 0.116, -0.107], 'source': 'ros-outline'},
                 'upperarm_housing': {'value': [0.093, 0.341], 'source': 'ros-outline'},
                 'upperarm_tube': {'value': [0.091, 0.076, 0.225], 'source': 'ros-outline'},
                 'elbow_housing': {'value': [0.078, 0.317], 'source': 'ros-outline'},
                 'forearm_housing': {'value': [0.076, -0.009, 0.134], 'source': 'ros-outline'},
                 'forearm_tube': {'value': [0.073, 0.0485, 0.044], 'source': 'ros-outline'},
                 'forearm_end': {'value': [0.05, -0.033, 0.112], 'source': 'ros-outline'},
                 'wrist_1': {'value': [0.0485, -0.067, 0.078], 'source': 'ros-outline'},
                 'wrist_2': {'value': [0.0485, -0.078, 0.067], 'source': 'ros-outline'},
                 'wrist_3': {'value': [0.048, -0.054, 0.054], 'source': 'ros-outline'}},
     'joints': {'qd_max': {'deg': [120, 120, 150, 210, 210, 210], 'source': 'ros-limits'},
                'effort_max': {'value': [730.0, 730.0, 430.0, 100.0, 100.0, 100.0], 'source': 'ros-limits'},
                'torque_constant': {'value': [24.0, 24.0, 19.0, 11.0, 11.0, 11.0],
                                    'source': 'chosen',
                                    'why': 'N m/A at the joint, gear included; the rated torque then takes 1.5 to 30 '
                                           'A'}},
     'links': {'shoulder': {'mass': {'value': 17.04, 'source': 'ros-masses'},
                            'com': {'value': [9.9e-05, -0.026311, -0.026723], 'source': 'ros-masses'},
                            'inertia': {'value': [0.106325157852, 0.073046249849, 0.102063573985, 3.8324395e-05,
                                                  -0.000151780632, 0.012644324855],
                                        'source': 'ros-inertia'}},
               'upperarm': {'mass': {'value': 26.543, 'source': 'ros-masses'},
                            'com': {'value': [-0.27762, -1.7e-05, 0.20184], 'source': 'ros-masses'},
                            'inertia': {'value': [0.115654480348, 2.98460944825, 2.97625495256, 0.00095799075,
                                                  0.052267751506, 6.3883535e-05],
                                        'source': 'ros-inertia'}},
               'forearm': {'mass': {'value': 7.816, 'source': 'ros-masses'},
                           'com': {'value': [-0.30259, 2.1e-05, 0.07237], 'source': 'ros-masses'},
                           'inertia': {'value': [0.026861346063, 0.584325855, 0.575161502044, -9.4662912e-05,
                                                 -0.044798193753, -2.621478e-06],
                                       'source': 'ros-inertia'}},
               'wrist_1': {'mass': {'value': 3.095, 'source': 'ros-masses'},
                           'com': {'value': [-3.7e-05, -0.01051, -0.014865], 'source': 'ros-masses'},
                           'inertia': {'value': [0.006932629334, 0.006002399107, 0.004498821753, 4.227553e-06,
                                                 -4.031735e-06, 0.000465875409],
                                       'source': 'ros-inertia',
                                       'why': 'CS620 and CS625 print Ixz and Iyz of this link with opposite signs; one '
                                              'is a slip, below 1e-4 kg m^2'}},
               'wrist_2': {'mass': {'value': 3.095, 'source': 'ros-masses'},
                           'com': {'value': [3.7e-05, 0.01051, -0.014865], 'source': 'ros-masses'},
                           'inertia': {'value': [0.006932642334, 0.006002447107, 0.004498792753, 4.227553e-06,
                                                 -7.436265e-06, -0.000501195409],
                                       'source': 'ros-inertia'}},
               'wrist_3': {'mass': {'value': 0.879, 'source': 'ros-masses'},
                           'com': {'value': [0.000242, -0.001192, -0.050422], 'source': 'ros-masses'},
                           'inertia': {'value': [0.001829851725, 0.001825570186, 0.001169091583, -1.543856e-05,
                                                 7.27333e-07, 1.0678558e-05],
                                       'source': 'ros-inertia'}}}}
