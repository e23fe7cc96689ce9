"""The content of `cs620.toml`. Written by `python tools/write_reference.py`; do not edit."""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


def document() -> dict[str, Any]:
    """Return the tables of the file, made anew."""
    # fmt: off
    return {'name': 'CS620',
     'type_id': {'value': 6220, 'source': 'sdk', 'why': "number of the model in the vendor's simulator"},
     'payload_max_kg': {'value': 20.0, 'source': 'model-number'},
     'reach_m': {'value': 1.8, 'source': 'datasheet-quoted'},
     'max_tool_speed': {'value': 2.5,
                        'source': 'chosen',
                        'why': 'the base joint at its limit moves the stretched arm with 3.8 m/s'},
     'arm': {'d1': {'value': 0.235, 'source': 'ros-kinematics'},
             'a2': {'value': -0.9, 'source': 'ros-kinematics'},
             'a3': {'value': -0.772, 'source': 'ros-kinematics'},
             'd4': {'value': 0.1725, 'source': 'ros-kinematics'},
             'd5': {'value': 0.128, 'source': 'ros-kinematics'},
             'd6': {'value': 0.125, 'source': 'ros-kinematics'}},
     'outline': {'base': {'value': [0.12], 'source': 'ros-outline'},
                 'shoulder': {'value': [0.093, -0.118, 0.116, -0.107], 'source': 'ros-outline'},
                 'upperarm_housing': {'value': [0.093, 0.341], 'source': 'ros-outline'},
                 'upperarm_tube': {'value': [0.091, 0.076, 0.225], 'source': 'ros-outline'},
                 'elbow_housing': {'value': [0.078, 0.317], 'source': 'ros-outline'},
                 'forearm_housing': {'value': [0.076, -0.014, 0.134], 'source': 'ros-outline'},
                 'forearm_tube': {'value': [0.066, 0.0485, 0.045], 'source': 'ros-outline'},
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
                            'inertia': {'value': [0.106329828852, 0.073046537849, 0.102062731985, 3.8324395e-05,
                                                  -0.000151781632, 0.012644319855],
                                        'source': 'ros-inertia'}},
               'upperarm': {'mass': {'value': 26.927, 'source': 'ros-masses'},
                            'com': {'value': [-0.323686, -3.9e-05, 0.200968], 'source': 'ros-masses'},
                            'inertia': {'value': [0.116787188399, 4.164981772004, 4.159244484694, 0.000806855824,
                                                  0.037168751252, 9.4110852e-05],
                                        'source': 'ros-inertia'}},
               'forearm': {'mass': {'value': 8.386, 'source': 'ros-masses'},
                           'com': {'value': [-0.376841, 1.5e-05, 0.070311], 'source': 'ros-masses'},
                           'inertia': {'value': [0.028585616571, 0.928090727447, 0.918310940103, -0.000137585829,
                                                 -0.056534176483, -5.009579e-06],
                                       'source': 'ros-inertia'}},
               'wrist_1': {'mass': {'value': 3.095, 'source': 'ros-masses'},
                           'com': {'value': [-3.7e-05, -0.01051, -0.014865], 'source': 'ros-masses'},
                           'inertia': {'value': [0.006932642334, 0.006002447107, 0.004498792753, 4.227553e-06,
                                                 7.436265e-06, 0.000501195409],
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
