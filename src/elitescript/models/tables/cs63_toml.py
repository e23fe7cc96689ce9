"""The content of `cs63.toml`. Written by `python tools/write_reference.py`; do not edit."""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


def document() -> dict[str, Any]:
    """Return the tables of the file, made anew."""
    # fmt: off
    return {'name': 'CS63',
     'type_id': {'value': 6203, 'source': 'sdk', 'why': "number of the model in the vendor's simulator"},
     'payload_max_kg': {'value': 3.0, 'source': 'datasheet-quoted'},
     'reach_m': {'value': 0.624, 'source': 'datasheet-quoted'},
     'max_tool_speed': {'value': 2.0,
                        'source': 'chosen',
                        'why': 'the base joint at its limit moves the stretched arm with 2.0 m/s'},
     'arm': {'d1': {'value': 0.153, 'source': 'ros-kinematics'},
             'a2': {'value': -0.27, 'source': 'ros-kinematics'},
             'a3': {'value': -0.2575, 'source': 'ros-kinematics'},
             'd4': {'value': 0.1445, 'source': 'ros-kinematics'},
             'd5': {'value': 0.0965, 'source': 'ros-kinematics'},
             'd6': {'value': 0.092, 'source': 'ros-kinematics'}},
     'outline': {'base': {'value': [0.064], 'source': 'ros-outline'},
                 'shoulder': {'value': [0.05, -0.067, 0.078, -0.061], 'source': 'ros-outline'},
                 'upperarm_housing': {'value': [0.05, 0.206], 'source': 'ros-outline'},
                 'upperarm_tube': {'value': [0.046, 0.0435, 0.128], 'source': 'ros-outline'},
                 'elbow_housing': {'value': [0.045, 0.19], 'source': 'ros-outline'},
                 'forearm_housing': {'value': [0.043, -0.033, 0.061], 'source': 'ros-outline'},
                 'forearm_tube': {'value': [0.04, 0.038, 0.01], 'source': 'ros-outline'},
                 'forearm_end': {'value': [0.04, -0.057, 0.059], 'source': 'ros-outline'},
                 'wrist_1': {'value': [0.038, -0.049, 0.067], 'source': 'ros-outline'},
                 'wrist_2': {'value': [0.038, -0.067, 0.049], 'source': 'ros-outline'},
                 'wrist_3': {'value': [0.038, -0.044, 0.038], 'source': 'ros-outline'}},
     'joints': {'qd_max': {'deg': [180, 180, 180, 360, 360, 360], 'source': 'ros-limits'},
                'effort_max': {'value': [56.0, 56.0, 28.0, 12.0, 12.0, 12.0], 'source': 'ros-limits'},
                'torque_constant': {'value': [10.0, 10.0, 9.0, 8.0, 8.0, 8.0],
                                    'source': 'chosen',
                                    'why': 'N m/A at the joint, gear included; the rated torque then takes 1.5 to 30 '
                                           'A'}},
     'links': {'shoulder': {'mass': {'value': 3.095, 'source': 'ros-masses'},
                            'com': {'value': [3.7e-05, -0.0149, -0.0105], 'source': 'ros-masses'},
                            'inertia': {'value': [0.0069296553, 0.004498772013, 0.005998874813, -7.440273e-06,
                                                  -4.226408e-06, 0.00050191275],
                                        'source': 'ros-inertia'}},
               'upperarm': {'mass': {'value': 5.073, 'source': 'ros-masses'},
                            'com': {'value': [-0.11596, -2.6e-05, 0.1148], 'source': 'ros-masses'},
                            'inertia': {'value': [0.007310726651, 0.084297511403, 0.082824777894, 2.2794892e-05,
                                                  -0.001953831184, 6.75811e-06],
                                        'source': 'ros-inertia'}},
               'forearm': {'mass': {'value': 2.425, 'source': 'ros-masses'},
                           'com': {'value': [-0.1542, 1.4e-05, 0.0238], 'source': 'ros-masses'},
                           'inertia': {'value': [0.003708382525, 0.033386306, 0.032095122525, -2.53509e-06,
                                                 -0.003276053, 2.53401e-06],
                                       'source': 'ros-inertia'}},
               'wrist_1': {'mass': {'value': 1.559, 'source': 'ros-masses'},
                           'com': {'value': [1.3e-05, -0.00479, -0.02274], 'source': 'ros-masses'},
                           'inertia': {'value': [0.0036589594, 0.003410228988, 0.001418029885, -2.057079e-06,
                                                 2.185128e-06, 0.000170171451],
                                       'source': 'ros-inertia'}},
               'wrist_2': {'mass': {'value': 1.447, 'source': 'ros-masses'},
                           'com': {'value': [-1.4e-05, 0.0051, -0.0127], 'source': 'ros-masses'},
                           'inertia': {'value': [0.0021076769, 0.001852513086, 0.001281463246, -2.056316e-06,
                                                 -2.385723e-06, -9.930619e-05],
                                       'source': 'ros-inertia'}},
               'wrist_3': {'mass': {'value': 0.5, 'source': 'ros-masses'},
                           'com': {'value': [-0.000684, -0.000175, -0.0423], 'source': 'ros-masses'},
                           'inertia': {'value': [0.000536339688, 0.000535021072, 0.000326250759, 2.9185e-07, 6.5116e-06,
                                                 2.43525e-06],
                                       'source': 'ros-inertia'}}}}
