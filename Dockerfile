# Lodestone from its own packages, in Debian 12. Not built yet: where this was written no image could be fetched.
# What it does is what scripts/package does, which was tried in a bare Debian.
FROM debian:bookworm AS build
WORKDIR /lodestone
COPY . .
RUN scripts/setup && cmake --preset release && cmake --build --preset release && scripts/package --build build/release --no-check

FROM debian:bookworm-slim
COPY --from=build /lodestone/build/release/packages/lodestone_*.deb /tmp/
RUN apt-get update && apt-get install -y --no-install-recommends /tmp/lodestone_*.deb && rm -rf /tmp/*.deb /var/lib/apt/lists/*
WORKDIR /usr/share/lodestone
ENTRYPOINT ["lodestone"]
