"""A publisher of the wrong type, as others see it on Zenoh: by its liveliness token."""

import os
import signal

import zenoh

config = zenoh.Config()
config.insert_json5("mode", '"client"')
config.insert_json5("connect/endpoints", f'["tcp/127.0.0.1:{os.environ["ZENOH_PORT"]}"]')
with zenoh.open(config) as session:
    domain, unknown = os.environ["ROS_DOMAIN_ID"], "RIHS01_" + "0" * 64
    kind = f"sensor_msgs::msg::dds_::CameraInfo_/{unknown}"
    token = f"@ros2_lv/{domain}/{session.zid()}/0/1/MP/%/%/driver/%odom/{kind}/::,10:,:,:,,"
    _token = session.liveliness().declare_token(token)
    signal.pause()
