/* The least that a scan of a chart costs: a loop over the active steps of a ring of 1000, in which a
 * step waits for one input and has one output. Each line on the standard input asks for one
 * measurement: ns a scan, moving and waiting. */
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <time.h>

enum { STEPS = 1000, SCANS = 200000 };

struct step { uint32_t input, to, output; };

static struct step steps[STEPS];
static uint32_t active[STEPS], next[STEPS];
static uint32_t count = 1;
static bool inputs[2], outputs[STEPS];
static int64_t stamps[STEPS];

static uint64_t ns(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (uint64_t)t.tv_sec * 1000000000u + (uint64_t)t.tv_nsec;
}

__attribute__((noinline)) static void scan(const volatile bool *in, int64_t now) {
  inputs[0] = in[0];
  inputs[1] = in[1];
  uint32_t n = 0;
  for (uint32_t k = 0; k < count; k++) {
    const struct step *s = &steps[active[k]];
    if (inputs[s->input]) {
      outputs[s->output] = false;
      outputs[steps[s->to].output] = true;
      stamps[s->to] = now;
      next[n++] = s->to;
    } else {
      next[n++] = active[k];
    }
  }
  for (uint32_t k = 0; k < n; k++) {
    active[k] = next[k];
  }
  count = n;
}

int main(void) {
  char line[16];
  int64_t now = 0;
  for (uint32_t i = 0; i < STEPS; i++) {
    steps[i] = (struct step){.input = 0, .to = (i + 1) % STEPS, .output = i};
  }
  while (fgets(line, sizeof line, stdin)) {
    double t[2];
    for (int go = 1; go >= 0; go--) {
      volatile bool in[2] = {go, false};
      const uint64_t start = ns();
      for (int k = 0; k < SCANS; k++) {
        in[1] = !go && k % 2;
        scan(in, now += 1000000);
      }
      t[go] = (double)(ns() - start) / SCANS;
    }
    printf("%.3f %.3f\n", t[1], t[0]);
    fflush(stdout);
  }
  return 0;
}
