/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Functions of FMI 3.0 that belong to other kinds of units. The standard wants them to be there. They fail.
 */
#include "fmi3.h"

#define NOT_HERE \
  { return (void)failed(instance, "this unit has no such function"), fmi3Error; }
#define OF fmi3Instance instance, const fmi3ValueReference references[], size_t count
#define NO_VALUES(type)                                                      \
  EXPORT fmi3Status fmi3Get##type(OF, fmi3##type values[], size_t n) {       \
    (void)references, (void)count, (void)values, (void)n;                    \
    NOT_HERE                                                                 \
  }                                                                          \
  EXPORT fmi3Status fmi3Set##type(OF, const fmi3##type values[], size_t n) { \
    (void)references, (void)count, (void)values, (void)n;                    \
    NOT_HERE                                                                 \
  }
NO_VALUES(Float32)
NO_VALUES(Int8)
NO_VALUES(UInt8)
NO_VALUES(Int16)
NO_VALUES(UInt16)
NO_VALUES(Int32)
NO_VALUES(UInt32)

#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif
EXPORT fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources,
                                                 fmi3Boolean visible, fmi3Boolean logs,
                                                 fmi3InstanceEnvironment environment, fmi3LogMessageCallback log) {
  return NULL;
}
EXPORT fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources,
                                                      fmi3Boolean visible, fmi3Boolean logs,
                                                      fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                                      fmi3ClockUpdateCallback update, fmi3LockPreemptionCallback lock,
                                                      fmi3UnlockPreemptionCallback unlock) {
  return NULL;
}
EXPORT fmi3Status fmi3GetBinary(OF, size_t sizes[], fmi3Binary values[], size_t n) NOT_HERE EXPORT fmi3Status
    fmi3SetBinary(OF, const size_t sizes[], const fmi3Binary values[], size_t n) NOT_HERE EXPORT fmi3Status
    fmi3GetClock(OF, fmi3Clock values[]) NOT_HERE EXPORT fmi3Status
    fmi3SetClock(OF, const fmi3Clock values[]) NOT_HERE EXPORT fmi3Status
    fmi3EnterEventMode(fmi3Instance instance) NOT_HERE EXPORT fmi3Status
    fmi3GetNumberOfVariableDependencies(fmi3Instance instance, fmi3ValueReference of,
                                        size_t* n) NOT_HERE EXPORT fmi3Status
    fmi3GetVariableDependencies(fmi3Instance instance, fmi3ValueReference of, size_t elements[],
                                fmi3ValueReference others[], size_t other_elements[], fmi3DependencyKind kinds[],
                                size_t n) NOT_HERE EXPORT fmi3Status
    fmi3GetFMUState(fmi3Instance instance, fmi3FMUState* state) NOT_HERE EXPORT fmi3Status
    fmi3SetFMUState(fmi3Instance instance, fmi3FMUState state) NOT_HERE EXPORT fmi3Status
    fmi3FreeFMUState(fmi3Instance instance, fmi3FMUState* state) NOT_HERE EXPORT fmi3Status
    fmi3SerializedFMUStateSize(fmi3Instance instance, fmi3FMUState state, size_t* size) NOT_HERE EXPORT fmi3Status
    fmi3SerializeFMUState(fmi3Instance instance, fmi3FMUState state, fmi3Byte to[], size_t n) NOT_HERE EXPORT fmi3Status
    fmi3DeserializeFMUState(fmi3Instance instance, const fmi3Byte from[], size_t n,
                            fmi3FMUState* state) NOT_HERE EXPORT fmi3Status
    fmi3GetDirectionalDerivative(OF, const fmi3ValueReference knowns[], size_t known_count, const fmi3Float64 seed[],
                                 size_t seeds, fmi3Float64 to[], size_t n) NOT_HERE EXPORT fmi3Status
    fmi3GetAdjointDerivative(OF, const fmi3ValueReference knowns[], size_t known_count, const fmi3Float64 seed[],
                             size_t seeds, fmi3Float64 to[], size_t n) NOT_HERE EXPORT fmi3Status
    fmi3EnterConfigurationMode(fmi3Instance instance) NOT_HERE EXPORT fmi3Status
    fmi3ExitConfigurationMode(fmi3Instance instance) NOT_HERE EXPORT fmi3Status
    fmi3GetIntervalDecimal(OF, fmi3Float64 intervals[], fmi3IntervalQualifier how[]) NOT_HERE EXPORT fmi3Status
    fmi3GetIntervalFraction(OF, fmi3UInt64 counters[], fmi3UInt64 resolutions[],
                            fmi3IntervalQualifier how[]) NOT_HERE EXPORT fmi3Status
    fmi3GetShiftDecimal(OF, fmi3Float64 shifts[]) NOT_HERE EXPORT fmi3Status
    fmi3GetShiftFraction(OF, fmi3UInt64 counters[], fmi3UInt64 resolutions[]) NOT_HERE EXPORT fmi3Status
    fmi3SetIntervalDecimal(OF, const fmi3Float64 intervals[]) NOT_HERE EXPORT fmi3Status
    fmi3SetIntervalFraction(OF, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[]) NOT_HERE EXPORT fmi3Status
    fmi3SetShiftDecimal(OF, const fmi3Float64 shifts[]) NOT_HERE EXPORT fmi3Status
    fmi3SetShiftFraction(OF, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[]) NOT_HERE EXPORT fmi3Status
    fmi3EvaluateDiscreteStates(fmi3Instance instance) NOT_HERE EXPORT fmi3Status
    fmi3EnterContinuousTimeMode(fmi3Instance instance) NOT_HERE EXPORT fmi3Status
    fmi3CompletedIntegratorStep(fmi3Instance instance, fmi3Boolean keeps, fmi3Boolean* event,
                                fmi3Boolean* terminate) NOT_HERE EXPORT fmi3Status
    fmi3SetTime(fmi3Instance instance, fmi3Float64 time_s) NOT_HERE EXPORT fmi3Status
    fmi3SetContinuousStates(fmi3Instance instance, const fmi3Float64 states[], size_t n) NOT_HERE EXPORT fmi3Status
    fmi3GetContinuousStateDerivatives(fmi3Instance instance, fmi3Float64 to[], size_t n) NOT_HERE EXPORT fmi3Status
    fmi3GetEventIndicators(fmi3Instance instance, fmi3Float64 to[], size_t n) NOT_HERE EXPORT fmi3Status
    fmi3GetContinuousStates(fmi3Instance instance, fmi3Float64 to[], size_t n) NOT_HERE EXPORT fmi3Status
    fmi3GetNominalsOfContinuousStates(fmi3Instance instance, fmi3Float64 to[], size_t n) NOT_HERE EXPORT fmi3Status
    fmi3GetNumberOfEventIndicators(fmi3Instance instance, size_t* n) NOT_HERE EXPORT fmi3Status
    fmi3GetNumberOfContinuousStates(fmi3Instance instance, size_t* n) NOT_HERE EXPORT fmi3Status
    fmi3GetOutputDerivatives(OF, const fmi3Int32 orders[], fmi3Float64 to[], size_t n) NOT_HERE EXPORT fmi3Status
    fmi3ActivateModelPartition(fmi3Instance instance, fmi3ValueReference clock, fmi3Float64 time_s) NOT_HERE
