"""The content of `cs66.toml`. Written by `python tools/write_reference.py`; do not edit."""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


def document() -> dict[str, Any]:
    """Return the tables of the file, made anew."""
    # fmt: off
    return {'name': 'CS66',
     'type_id': {'value': 6206, 'source': 'sdk', 'why': "number of the model in the vendor's simulator"},
     'payload_max_kg': {'value': 6.0, 'source': 'model-number'},
     'reach_m': {'value': 0.914, 'source': 'datasheet-quoted'},
     'max_tool_speed': {'value': 2.5,
                        'source': 'chosen',
                        'why': 'the base joint at its limit moves the stretched arm with 2.4 m/s'},
     'arm': {'d1': {'value': 0.1625, 'source': 'ros-kinematics'},
             'a2': {'value': -0.427, 'source': 'ros-kinematics'},
             'a3': {'value': -0.3905, 'source': 'ros-kinematics'},
             'd4': {'value': 0.1475, 'source': 'ros-kinematics'},
             'd5': {'value': 0.0965, 'source': 'ros-kinematics'},
             'd6': {'value': 0.092, 'source': 'ros-kinematics'}},
     'outline': {'base': {'value': [0.075], 'source': 'ros-outline'},
                 'shoulder': {'value': [0.06, -0.071, 0.077, -0.07], 'source': 'ros-outline'},
                 'upperarm_housing': {'value': [0.061, 0.219], 'source': 'ros-outline'},
                 'upperarm_tube': {'value': [0.059, 0.0485, 0.141], 'source': 'ros-outline'},
                 'elbow_housing': {'value': [0.05, 0.219], 'source': 'ros-outline'},
                 'forearm_housing': {'value': [0.049, -0.031, 0.074], 'source': 'ros-outline'},
                 'forearm_tube': {'value': [0.0485, 0.038, 0.013], 'source': 'ros-outline'},
                 'forearm_end': {'value': [0.04, -0.054, 0.062], 'source': 'ros-outline'},
                 'wrist_1': {'value': [0.038, -0.049, 0.067], 'source': 'ros-outline'},
                 'wrist_2': {'value': [0.038, -0.067, 0.049], 'source': 'ros-outline'},
                 'wrist_3': {'value': [0.038, -0.044, 0.038], 'source': 'ros-outline'}},
     'joints': {'qd_max': {'deg': [150, 150, 180, 230, 230, 230],
                           'source': 'datasheet-quoted',
                           'why': 'ros-limits has 180 for all six'},
                'effort_max': {'value': [150.0, 150.0, 150.0, 28.0, 28.0, 28.0], 'source': 'ros-limits'},
                'torque_constant': {'value': [12.5, 12.5, 12.5, 9.0, 9.0, 9.0],
                                    'source': 'chosen',
                                    'why': 'N m/A at the joint, gear included; the rated torque then takes 1.5 to 30 '
                                           'A'}},
     'links': {'shoulder': {'mass': {'value': 4.521, 'source': 'ros-masses'},
                            'com': {'value': [2.2e-05, -0.016526, -0.014442], 'source': 'ros-masses'},
                            'inertia': {'value': [0.012014324539, 0.008255246675, 0.011542273488, -1.9482709e-05,
                                                  -4.0943e-07, 0.001125798252],
                                        'source': 'ros-inertia'}},
               'upperarm': {'mass': {'value': 7.533, 'source': 'ros-masses'},
                            'com': {'value': [-0.17828, 4e-06, 0.12803], 'source': 'ros-masses'},
                            'inertia': {'value': [0.01371146766, 0.298494415753, 0.297062947852, 7.0304067e-05,
                                                  0.003567855783, -3.7322e-06],
                                        'source': 'ros-inertia'}},
               'forearm': {'mass': {'value': 3.009, 'source': 'ros-masses'},
                           'com': {'value': [-0.20416, -7e-06, 0.03064], 'source': 'ros-masses'},
                           'inertia': {'value': [0.005935521766, 0.094566073363, 0.092180951302, -1.3461778e-05,
                                                 -0.008057686362, -2.3237e-07],
                                       'source': 'ros-inertia'}},
               'wrist_1': {'mass': {'value': 1.559, 'source': 'ros-masses'},
                           'com': {'value': [1.3e-05, -0.00479, -0.02274], 'source': 'ros-masses'},
                           'inertia': {'value': [0.0036589594, 0.003410228988, 0.001418129885, -2.058079e-06,
                                                 2.185128e-06, 0.000170171451],
                                       'source': 'ros-inertia'}},
               'wrist_2': {'mass': {'value': 1.447, 'source': 'ros-masses'},
                           'com': {'value': [-1.4e-05, 0.005107, -0.012702], 'source': 'ros-masses'},
                           'inertia': {'value': [0.0021075, 0.001852439573, 0.00128135986, -2.056458e-06, -2.385683e-06,
                                                 -9.9449608e-05],
                                       'source': 'ros-inertia'}},
               'wrist_3': {'mass': {'value': 0.5, 'source': 'ros-masses'},
                           'com': {'value': [-0.000684, -0.000175, -0.04234], 'source': 'ros-masses'},
                           'inertia': {'value': [0.000535046887, 0.000533328272, 0.000326250759, 2.9185e-07,
                                                 6.52528e-06, 2.43875e-06],
                                       'source': 'ros-inertia'}}}}
