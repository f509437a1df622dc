"""The words of each line of the standard input, for a program that serves meanwhile. An empty line ends them."""

import asyncio
import sys
import threading


async def lines():
    loop, queue = asyncio.get_running_loop(), asyncio.Queue()

    def read():
        for line in sys.stdin:
            loop.call_soon_threadsafe(queue.put_nowait, line.split())
        loop.call_soon_threadsafe(queue.put_nowait, None)

    threading.Thread(target=read, daemon=True).start()
    while words := await queue.get():
        yield words
