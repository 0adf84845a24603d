/* SPDX-License-Identifier: BSD-3-Clause
 * The seam between the board and gateware compiled by Verilator: a shared library that exports `unitylink_rtl_model`.
 * Every input goes through a register of the model, so it takes effect one clock later.
 */
#ifndef UNITYLINK_RTL_MODEL_H
#define UNITYLINK_RTL_MODEL_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define UNITYLINK_RTL_ABI 4u /* raised whenever something below changes */

/* A byte moves at the end of a clock in which its valid and its ready are both high. */
typedef struct unitylink_rtl_pins {
  /* inputs of the model, from the next clock on */
  uint8_t reset;
  uint8_t rx_valid;
  uint8_t rx_data;
  uint8_t rx_error; /* 1 parity, 2 framing, 4 overrun */
  uint8_t tx_ready;
  /* outputs of the model in the present clock */
  uint8_t rx_ready;
  uint8_t tx_valid;
  uint8_t tx_data;
} unitylink_rtl_pins;

typedef struct unitylink_rtl {
  uint32_t abi;          /* UNITYLINK_RTL_ABI */
  uint32_t read_words;   /* words the PC reads, as many as `set_word` takes */
  uint32_t write_words;  /* words the PC writes, as many as `words` points to */
  uint32_t groups;       /* event lines */
  void* (*create)(void); /* NULL: there is no memory */
  void (*destroy)(void* model);
  void (*clock)(void* model, unitylink_rtl_pins* pins);
  void (*set_word)(void* model, uint32_t index, uint32_t value);
  const uint32_t* (*words)(const void* model);                /* the words that the PC writes; they keep this place */
  uint32_t (*was_written)(const void* model, uint32_t index); /* 1 in the first clock of a new word */
  void (*set_event)(void* model, uint32_t group, uint32_t high);
  const char* (*failure)(const void* model); /* the assertion of the gateware that failed, "" while none has */
  uint32_t input_pins;                       /* pins of components, those of all ports side by side */
  uint32_t output_pins;
  void (*set_pin)(void* model, uint32_t index, uint32_t high);
  uint32_t (*get_pins)(const void* model, uint32_t word); /* 32 output pins, the first in bit 0 */
} unitylink_rtl;

const unitylink_rtl* unitylink_rtl_model(void);

/* Within the model: an assertion at `place` ("fifo.vhd:73") has failed. */
void unitylink_failed(const char* place);

#ifdef __cplusplus
}
#endif

#endif
