"""A participant on Cyclone DDS in the test's domain: topics and services of ROS 2, and waiting."""

import os
import sys
import time

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

PATIENCE_S = 60.0

participant = DomainParticipant(int(os.environ["ROS_DOMAIN_ID"]))
reliable = Policy.Reliability.Reliable(duration(seconds=10))
LATCHED = Qos(reliable, Policy.Durability.TransientLocal, Policy.History.KeepLast(100))
PLAIN = Qos(reliable, Policy.Durability.Volatile, Policy.History.KeepLast(500))


def wait_for(what, condition):
    end = time.monotonic() + PATIENCE_S
    while not (found := condition()):
        if time.monotonic() > end:
            sys.exit(f"{what} did not come")
        time.sleep(0.02)
    return found


def writer(topic, kind, qos=PLAIN):
    return DataWriter(participant, Topic(participant, f"rt{topic}", kind), qos=qos)


def reader(topic, kind, qos=PLAIN):
    return DataReader(participant, Topic(participant, f"rt{topic}", kind), qos=qos)


def client(name, request, response):
    """Calls a service of the node: on DDS it is a topic for requests and one for replies."""
    requests = Topic(participant, f"rq/ellipsoid_slam/{name}Request", request)
    replies = Topic(participant, f"rr/ellipsoid_slam/{name}Reply", response)
    asking, answers = DataWriter(participant, requests, qos=PLAIN), DataReader(participant, replies, qos=PLAIN)
    matched = lambda: asking.get_matched_subscriptions() and answers.get_matched_publications()
    wait_for(f"the service {name}", matched)

    def call(**given):
        asking.write(request(**given))
        return wait_for(f"the answer of {name}", lambda: answers.take(N=1))[0]

    return call
