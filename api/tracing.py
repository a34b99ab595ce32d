"""Traces by OpenTelemetry, for those who installed `livella[otel]` and name a collector; nothing otherwise."""

import logging
import os

from fastapi import FastAPI

log = logging.getLogger(__name__)

ENDPOINT = "OTEL_EXPORTER_OTLP_ENDPOINT"
"""environment variable, read by OpenTelemetry as are its others"""


def install(app: FastAPI) -> bool:
    """Trace requests and database statements, if wanted; tell whether they are."""
    if ENDPOINT not in os.environ:
        return False
    try:
        _instrument(app)
    except ImportError as error:
        log.warning("%s is set, but %s is not installed: `pip install livella[otel]`", ENDPOINT, error.name)
        return False
    return True


def _instrument(app: FastAPI) -> None:
    from opentelemetry.exporter.otlp.proto.http.trace_exporter import OTLPSpanExporter
    from opentelemetry.instrumentation.fastapi import FastAPIInstrumentor
    from opentelemetry.instrumentation.sqlalchemy import SQLAlchemyInstrumentor
    from opentelemetry.sdk.resources import Resource
    from opentelemetry.sdk.trace import TracerProvider
    from opentelemetry.sdk.trace.export import BatchSpanProcessor

    resource = Resource.create({"service.name": os.environ.get("OTEL_SERVICE_NAME", "livella")})
    provider = TracerProvider(resource=resource)
    provider.add_span_processor(BatchSpanProcessor(OTLPSpanExporter()))
    SQLAlchemyInstrumentor().instrument(tracer_provider=provider, skip_dep_check=True)  # it works beyond its stated 2.0
    FastAPIInstrumentor.instrument_app(app, tracer_provider=provider, excluded_urls="healthz,readyz,metrics,stream")
