"""The routes, a file per resource."""

from fastapi import APIRouter

from api.routes import alerts, chunks, devices, fleet, installations, session, stream, webhooks

api = APIRouter(prefix="/api/v1")
for resource in (session, devices, chunks, installations, alerts, webhooks, fleet, stream):
    api.include_router(resource.router)
