"""The files in `deploy/` agree with the service and with one another, as far as that is seen without running them."""

import json
import os
import re
import shlex
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml
from fastapi import FastAPI

from api.app import create_app
from api.commands.serve import GRACE, KEEP_ALIVE
from api.settings import PREFIX, Settings

ROOT = Path(__file__).parents[2]
DEPLOY = ROOT / "deploy"
SETTINGS = {f"{PREFIX}{name.upper()}" for name in Settings.model_fields}
FILES = sorted(path for path in DEPLOY.rglob("*") if path.is_file())
Yaml = dict[str, Any]


def instructions() -> list[tuple[str, str]]:
    text = (DEPLOY / "Dockerfile").read_text().replace("\\\n", " ")
    lines = [line.strip() for line in text.splitlines() if line.strip() and not line.startswith("#")]
    return [(line.partition(" ")[0], line.partition(" ")[2]) for line in lines]


def last_stage() -> list[tuple[str, str]]:
    made = instructions()
    return made[max(n for n, (word, _) in enumerate(made) if word == "FROM") :]


def compose() -> Yaml:
    read: Yaml = yaml.safe_load((DEPLOY / "compose.yaml").read_text())
    return read


def manifests() -> dict[str, Yaml]:
    texts = [path.read_text() for path in (DEPLOY / "kubernetes").glob("*.yaml")]
    return {made["kind"]: made for text in texts for made in yaml.safe_load_all(text)}


@pytest.fixture
def pod() -> Yaml:
    read: Yaml = manifests()["Deployment"]["spec"]["template"]["spec"]
    return read


@pytest.fixture
def container(pod: Yaml) -> Yaml:
    (read,) = pod["containers"]
    assert isinstance(read, dict)
    return read


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_every_setting_named_exists(path: Path) -> None:
    named = set(re.findall(rf"\b{PREFIX}[A-Z_]+", path.read_text()))
    assert named <= SETTINGS


def paths_of(app: FastAPI) -> Iterator[str]:
    yield from app.openapi()["paths"]
    yield "/metrics"


# ---------------------------------------------------------------- image


def test_what_is_copied_is_there_and_not_ignored() -> None:
    allowed = {line[1:] for line in (ROOT / ".dockerignore").read_text().splitlines() if line.startswith("!")}
    for word, rest in instructions():
        if word != "COPY" or "--from=" in rest:
            continue
        for source in shlex.split(rest)[:-1]:
            assert (ROOT / source).exists(), source
            assert source in allowed or source.split("/")[0] in allowed, source


def test_every_package_is_copied() -> None:
    text = (ROOT / "pyproject.toml").read_text()
    packages = {name.split(".")[0] for name in json.loads(re.findall(r"^packages = (\[.*\])$", text, re.M)[0])}
    copied = {rest.split()[0] for word, rest in instructions() if word == "COPY"}
    assert packages <= copied


def test_the_image_runs_as_nobody_in_particular() -> None:
    users = [rest for word, rest in last_stage() if word == "USER"]
    assert len(users) == 1
    assert int(users[0].split(":")[0]) > 0
    assert re.search(rf"--uid {users[0].split(':')[0]} ", " ".join(rest for _, rest in last_stage()))


def test_the_health_check_and_the_port_are_those_of_the_service() -> None:
    words = dict(last_stage())
    assert f":{words['EXPOSE']}/healthz" in words["HEALTHCHECK"]
    assert f"LIVELLA_PORT={words['EXPOSE']} " in words["ENV"]
    compile(json.loads(words["HEALTHCHECK"].partition("CMD ")[2])[2], "health check", "exec")
    assert "/healthz" in set(paths_of(create_app()))


def test_the_compiled_estimator_is_found_again() -> None:
    made = [rest for word, rest in instructions() if word == "ENV"]
    processors = {re.search(r"NUMBA_CPU_NAME=(\S+)", rest).group(1) for rest in made}  # type: ignore[union-attr]
    assert len(processors) == 1, "code compiled for another processor is compiled anew"
    start = DEPLOY / "start"
    assert os.access(start, os.X_OK)
    baked = re.search(r"NUMBA_CACHE_DIR=(\S+)", made[0])
    assert baked is not None
    assert f"cp -r {baked.group(1)}/. " in start.read_text()
    assert 'exec livella "$@"' in start.read_text()


# ---------------------------------------------------------------- compose


def test_compose_has_two_replicas_behind_a_proxy() -> None:
    services = compose()["services"]
    livella = services["livella"]
    assert livella["deploy"]["replicas"] == 2
    assert "ports" not in livella, "only the proxy is reached from outside"
    assert (DEPLOY / livella["build"]["context"] / livella["build"]["dockerfile"]).is_file()
    (port,) = livella["expose"]
    assert port == dict(last_stage())["EXPOSE"]
    proxy = (DEPLOY / "Caddyfile").read_text()
    assert f"dynamic a livella {port}" in proxy
    assert "flush_interval -1" in proxy
    assert "respond @inside 404" in proxy
    keepalive = re.search(r"\tkeepalive (\d+)s", proxy)
    assert keepalive is not None
    assert int(keepalive.group(1)) < KEEP_ALIVE
    assert livella["read_only"]
    assert int(livella["stop_grace_period"].rstrip("s")) > GRACE


def test_compose_asks_for_nothing_that_the_example_lacks() -> None:
    example = {line.partition("=")[0] for line in (DEPLOY / "example.env").read_text().splitlines() if "=" in line}
    asked = set(re.findall(r"\$\{(\w+)", (DEPLOY / "compose.yaml").read_text()))
    assert asked == example


def test_volumes_named_exist() -> None:
    read = compose()
    used = {
        volume.partition(":")[0]
        for service in read["services"].values()
        for volume in service.get("volumes", [])
        if not volume.startswith(".")
    }
    assert used == set(read["volumes"])


# ---------------------------------------------------------------- Kubernetes


def test_all_manifests_are_there() -> None:
    kinds = {"Deployment", "Service", "Ingress", "PodDisruptionBudget", "Secret"}
    assert set(manifests()) == kinds
    assert manifests()["Deployment"]["spec"]["replicas"] == 2


def test_ports_and_names_lead_to_the_container(container: Yaml) -> None:
    found = manifests()
    (port,) = container["ports"]
    assert str(port["containerPort"]) == dict(last_stage())["EXPOSE"]
    (service_port,) = found["Service"]["spec"]["ports"]
    assert service_port["targetPort"] == port["name"]
    (path,) = found["Ingress"]["spec"]["rules"][0]["http"]["paths"]
    assert path["backend"]["service"] == {"name": "livella", "port": {"name": service_port["name"]}}
    labels = found["Deployment"]["spec"]["template"]["metadata"]["labels"]
    for selected in (
        found["Service"]["spec"]["selector"],
        found["Deployment"]["spec"]["selector"]["matchLabels"],
        found["PodDisruptionBudget"]["spec"]["selector"]["matchLabels"],
    ):
        assert selected.items() <= labels.items()
    assert container["envFrom"] == [{"secretRef": {"name": found["Secret"]["metadata"]["name"]}}]


def test_probes_ask_what_the_service_answers(container: Yaml) -> None:
    answered = set(paths_of(create_app()))
    for probe in ("startupProbe", "readinessProbe", "livenessProbe"):
        assert container[probe]["httpGet"]["path"] in answered
        assert container[probe]["httpGet"]["port"] == container["ports"][0]["name"]
    assert container["livenessProbe"]["httpGet"]["path"] == "/healthz", "a missing database is no reason to restart"


def test_the_container_may_do_no_more_than_it_must(pod: Yaml, container: Yaml) -> None:
    user = next(rest for word, rest in last_stage() if word == "USER")
    assert pod["securityContext"]["runAsNonRoot"]
    assert f"{pod['securityContext']['runAsUser']}:{pod['securityContext']['runAsGroup']}" == user
    assert container["securityContext"] == {
        "allowPrivilegeEscalation": False,
        "readOnlyRootFilesystem": True,
        "capabilities": {"drop": ["ALL"]},
    }
    writable = {mount["mountPath"] for mount in container["volumeMounts"]}
    cache = re.search(r"NUMBA_CACHE_DIR=(\S+)", dict(last_stage())["ENV"])
    assert cache is not None
    assert {"/tmp", cache.group(1)} <= writable  # noqa: S108 - inside the container
    assert {"cpu", "memory"} <= set(container["resources"]["requests"])
    assert "memory" in container["resources"]["limits"]


def test_there_is_time_to_stop(pod: Yaml, container: Yaml) -> None:
    wait = int(container["lifecycle"]["preStop"]["exec"]["command"][1])
    assert pod["terminationGracePeriodSeconds"] > wait + GRACE
