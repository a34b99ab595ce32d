"""The routes, a file per resource."""

from fastapi import APIRouter

from api.routes import (
    alerts,
    audit,
    chunks,
    devices,
    fleet,
    installations,
    keys,
    motion,
    session,
    stream,
    thresholds,
    webhooks,
)

api = APIRouter(prefix="/api/v1")
for resource in (
    session,
    devices,
    chunks,
    installations,
    motion,
    alerts,
    webhooks,
    fleet,
    thresholds,
    stream,
    keys,
    audit,
):
    api.include_router(resource.router)
