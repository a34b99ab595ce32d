"""Where webhooks may go: connections only to addresses that were checked after the name was resolved.

The name is resolved once, every address is checked, and the connection is made to a checked address: a name server that
answers otherwise the next time changes nothing. The name in the URL stays what Host and TLS are about.
"""

import socket
import ssl
import time
from collections.abc import Iterable
from ipaddress import IPv4Address, IPv4Network, IPv6Address, IPv6Network, ip_address
from typing import Any

import httpcore

Address = IPv4Address | IPv6Address
GLOBAL_IPV6 = IPv6Network("2000::/3")
NAT64 = IPv6Network("64:ff9b::/96")
SPECIAL_IPV4 = (IPv4Network("192.0.0.0/24"), IPv4Network("192.88.99.0/24"))
SPECIAL_IPV6 = (IPv6Network("2001::/23"), IPv6Network("3fff::/20"))


class RefusedAddressError(httpcore.ConnectError):
    """The address is not one of the public internet."""

    def __init__(self) -> None:
        super().__init__("the address is not one of the public internet")


def is_public(address: Address) -> bool:
    """Tell whether an address is one of the public internet, also when it is wrapped in an IPv6 address."""
    if isinstance(address, IPv6Address):
        inner = _inside(address)
        if inner is not None:
            return is_public(inner)
        ordinary = address in GLOBAL_IPV6 and not any(address in network for network in SPECIAL_IPV6)
    else:
        ordinary = not any(address in network for network in SPECIAL_IPV4)
    return ordinary and address.is_global and not (address.is_multicast or address.is_reserved)


def _inside(address: IPv6Address) -> IPv4Address | None:
    """Give the IPv4 address that an IPv6 address stands for."""
    if address in NAT64:
        return IPv4Address(int(address) & 0xFFFFFFFF)
    return address.ipv4_mapped or address.sixtofour


def resolve(host: str, port: int, allow_private: bool) -> list[str]:
    """Give the addresses of a name; refuse it when one of them may not be called."""
    try:
        found = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)
    except (OSError, UnicodeError, OverflowError) as error:
        raise httpcore.ConnectError("the name cannot be resolved") from error
    addresses = list(dict.fromkeys(str(entry[4][0]) for entry in found))
    if not allow_private and not all(is_public(ip_address(address)) for address in addresses):
        raise RefusedAddressError
    return addresses


class Backend(httpcore.SyncBackend):
    """Connects to checked addresses; a connection ends after `seconds` or `max_bytes` received, whatever goes on."""

    def __init__(self, allow_private: bool, seconds: float, max_bytes: int) -> None:
        self.allow_private = allow_private
        self.seconds = seconds
        self.max_bytes = max_bytes

    def connect_tcp(
        self,
        host: str,
        port: int,
        timeout: float | None = None,
        local_address: str | None = None,
        socket_options: Iterable[Any] | None = None,
    ) -> httpcore.NetworkStream:
        """Resolve, check, connect: to the first address that answers."""
        limits = Limits(self.seconds, self.max_bytes)
        refusal: Exception = httpcore.ConnectError("the name has no address")
        for address in resolve(host, port, self.allow_private):
            try:
                made = super().connect_tcp(address, port, limits.cut(timeout), local_address, socket_options)
            except (httpcore.ConnectError, httpcore.ConnectTimeout) as error:
                refusal = error
            else:
                return LimitedStream(made, limits)
        raise refusal


class Limits:
    """What is left of a connection's time and bytes."""

    def __init__(self, seconds: float, max_bytes: int) -> None:
        self.deadline = time.monotonic() + seconds
        self.bytes_left = max_bytes

    def cut(self, timeout: float | None) -> float:
        """Give the time left, at most `timeout`."""
        left = self.deadline - time.monotonic()
        if left <= 0:
            raise httpcore.ReadTimeout("the answer takes too long")
        return left if timeout is None else min(timeout, left)

    def count(self, size: int) -> None:
        """Take note of bytes received."""
        self.bytes_left -= size
        if self.bytes_left < 0:
            raise httpcore.ReadError("the answer is too large")


class LimitedStream(httpcore.NetworkStream):
    """A connection with an end in time and size."""

    def __init__(self, stream: httpcore.NetworkStream, limits: Limits) -> None:
        self.stream = stream
        self.limits = limits

    def read(self, max_bytes: int, timeout: float | None = None) -> bytes:
        """Receive."""
        received = self.stream.read(max_bytes, self.limits.cut(timeout))
        self.limits.count(len(received))
        return received

    def write(self, buffer: bytes, timeout: float | None = None) -> None:
        """Send."""
        self.stream.write(buffer, self.limits.cut(timeout))

    def close(self) -> None:
        """Hang up."""
        self.stream.close()

    def start_tls(
        self, ssl_context: ssl.SSLContext, server_hostname: str | None = None, timeout: float | None = None
    ) -> httpcore.NetworkStream:
        """Encrypt; the certificate has to be for the name in the URL."""
        secured = self.stream.start_tls(ssl_context, server_hostname, self.limits.cut(timeout))
        return LimitedStream(secured, self.limits)

    def get_extra_info(self, info: str) -> Any:
        """Tell about the connection."""
        return self.stream.get_extra_info(info)
