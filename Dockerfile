# docker build --tag fem_lie . && docker run fem_lie
# The image has everything installed, and has run the demo; a container of it runs the tests.
FROM debian:13

COPY . /fem_lie
WORKDIR /fem_lie
RUN tools/debian demo

CMD ["tools/debian", "test"]
