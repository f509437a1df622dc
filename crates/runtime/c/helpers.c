/* Helpers of printed C. This file is compiled and linted by a test; the build of
 * codegen follows its #define and #include lines and prints each function alone. */
#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "faults.h"
#include "numbers.h"
#include "reals.h"
#include "wide.h"
#include "text.h"

#define T int8_t
#define OF(op) op##_i8
#define FROM(type) i8_from_##type
#define T_MIN INT8_MIN
#define T_MAX INT8_MAX
#include "small.h"
#include "small_product.h"
#include "small_signed.h"
#include "text_signed.h"
#include "order.h"
#undef T
#undef OF
#undef FROM
#undef T_MIN
#undef T_MAX

#define T int16_t
#define OF(op) op##_i16
#define FROM(type) i16_from_##type
#define T_MIN INT16_MIN
#define T_MAX INT16_MAX
#include "small.h"
#include "small_product.h"
#include "small_signed.h"
#include "text_signed.h"
#include "order.h"
#undef T
#undef OF
#undef FROM
#undef T_MIN
#undef T_MAX

#define T int32_t
#define OF(op) op##_i32
#define FROM(type) i32_from_##type
#define T_MIN INT32_MIN
#define T_MAX INT32_MAX
#include "small.h"
#include "small_product.h"
#include "small_signed.h"
#include "text_signed.h"
#include "order.h"
#undef T
#undef OF
#undef FROM
#undef T_MIN
#undef T_MAX

#define T int64_t
#define OF(op) op##_i64
#define FROM(type) i64_from_##type
#define T_MIN INT64_MIN
#define T_MAX INT64_MAX
#include "text_signed.h"
#include "order.h"
#undef T
#undef OF
#undef FROM
#undef T_MIN
#undef T_MAX

#define T uint8_t
#define OF(op) op##_u8
#define FROM(type) u8_from_##type
#define T_MIN 0
#define T_MAX UINT8_MAX
#include "small.h"
#include "small_product.h"
#include "text_unsigned.h"
#include "bits.h"
#include "order.h"
#undef T
#undef OF
#undef FROM
#undef T_MIN
#undef T_MAX

#define T uint16_t
#define OF(op) op##_u16
#define FROM(type) u16_from_##type
#define T_MIN 0
#define T_MAX UINT16_MAX
#include "small.h"
#include "small_product.h"
#include "text_unsigned.h"
#include "bits.h"
#include "order.h"
#undef T
#undef OF
#undef FROM
#undef T_MIN
#undef T_MAX

#define T uint32_t
#define OF(op) op##_u32
#define FROM(type) u32_from_##type
#define T_MIN 0
#define T_MAX UINT32_MAX
#include "small.h"
#include "text_unsigned.h"
#include "bits.h"
#include "order.h"
#undef T
#undef OF
#undef FROM
#undef T_MIN
#undef T_MAX

#define T uint64_t
#define OF(op) op##_u64
#include "bits.h"
#include "order.h"
#undef T
#undef OF

#define T float
#define OF(op) op##_f32
#include "order.h"
#undef T
#undef OF

#define T double
#define OF(op) op##_f64
#include "order.h"
#undef T
#undef OF
